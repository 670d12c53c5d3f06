// Writes a mesh that is no fragment, with its appearance.

#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <algorithm>
#include <utility>

#include "base/files/file_bytes.h"
#include "base/text/formatted.h"
#include "base/text/safe_name.h"
#include "base/text/text_scan.h"
#include "formats/mesh/piece_mesh.h"
#include "formats/mesh_files/write_mesh.h"
#include "formats/ply/ply.h"
#include "mesh/single_rounding.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// Writes a file that a mesh refers to; one with the same content is kept.
void writeBeside(FileSink& files, const fs::path& file, const std::string& bytes) {
  if (fs::exists(fs::symlink_status(file))) {
    if (fs::is_regular_file(file) && readFileBytes(file) == bytes) return;
    throw Error(ErrorCode::output, file.string() +
                                       ": exists with other content; move it away or name "
                                       "another folder");
  }
  OutputFile(files, file).write(bytes);
}

// As kMostRoundingVoxels, which is a matter of fractures.
constexpr double kMostRounding = 0.01 / kMostAutoResolution;  // of the longest side

bool hasMaterials(const SourceMesh& source) { return !source.mesh.attributes.material.empty(); }

// Whether single precision moves points by more than a hundredth of a voxel at the highest
// automatic resolution.
bool isFar(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return false;
  const Box box = bounds(mesh);
  return singleRounding(box) > kMostRounding * longestSide(box);
}

}  // namespace

void writeMeshFile(FileSink& files, const fs::path& file, const SourceMesh& source,
                   MeshFileFormat format) {
  const SurfaceAttributes& attributes = source.mesh.attributes;
  const bool isDouble = isFar(source.mesh);
  if (format == MeshFileFormat::ply && source.mesh.neighbor.empty() && attributes.empty()) {
    return writePlainPly({files, file}, source.mesh, isDouble);
  }
  const MaterialTable table = materialTable(source.appearance);
  const std::string name = withoutBlanks(safeName(file.stem().string(), "mesh"));
  PieceMesh piece{name, source.mesh, attributes, table, isDouble};
  piece.coordinates = source.coordinates;
  if (format == MeshFileFormat::obj || format == MeshFileFormat::ply) {
    for (const MaterialTable::Image& image : table.textures) {
      writeBeside(files, file.parent_path() / image.file, image.bytes);
    }
  }
  const bool hasLibrary = format == MeshFileFormat::obj && hasMaterials(source);
  const std::string library = hasLibrary ? name + ".mtl" : "";
  if (hasLibrary) writeBeside(files, file.parent_path() / library, mtlText(table));
  writePiece({files, file}, format, piece, library);
}

std::vector<std::string> lossesOf(const SourceMesh& source, MeshFileFormat format) {
  std::vector<std::string> losses = source.warnings;
  const Appearance& appearance = source.appearance;
  if (source.degenerateTriangles > 0) {
    losses.push_back(std::to_string(source.degenerateTriangles) +
                     " triangles with two equal corners are left out");
  }
  const bool bare = format == MeshFileFormat::stl || format == MeshFileFormat::stlText ||
                    format == MeshFileFormat::binm;
  const SurfaceAttributes& attributes = source.mesh.attributes;
  if (bare && !attributes.hasOnlyNormals()) {
    losses.push_back("colors, texture coordinates and materials are left out");
  }
  if (bare && !attributes.normals.empty()) losses.push_back("normals of corners are left out");
  if (!source.mesh.neighbor.empty() && (bare || format == MeshFileFormat::obj)) {
    losses.push_back("neighbor ids of faces are left out");
  }
  if (!holdsDoubles(format) && isFar(source.mesh)) {
    losses.push_back(
        formatted("so far from the origin single precision moves points by up to %.2g "
                  "units; .ply, .obj and text .stl hold double precision",
                  singleRounding(bounds(source.mesh))));
  }
  for (const Texture& texture : appearance.textures) {
    if (format != MeshFileFormat::glb || imageType(texture.bytes) != ImageType::other) continue;
    losses.push_back("its texture " + inQuotes(texture.name) +
                     " is neither PNG nor JPEG and is left out");
  }
  return losses;
}

}  // namespace sherd
