// What is to be drawn, from whatever file or folder it is in.
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <sherd/render.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "base/input_error.h"
#include "base/lower_case.h"
#include "base/uncancelled.h"
#include "folder/partial_folder.h"
#include "folder/read_manifest.h"
#include "formats/mesh/read_facing.h"
#include "formats/voxels/vdb.h"
#include "surface/mesh.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

Fragment pieceOf(int id, TriangleMesh mesh, std::vector<std::uint16_t> facing = {}) {
  Fragment piece;
  piece.id = id;
  piece.mesh = std::move(mesh);
  piece.facing = std::move(facing);
  piece.mass = massProperties(piece.mesh);
  return piece;
}

std::vector<Fragment> fromLevelSets(const fs::path& file) {
  std::vector<Fragment> pieces;
  for (const NamedGrid& level : readLevelSets(file)) {
    pieces.push_back(pieceOf(static_cast<int>(pieces.size()) + 1, meshInWorld(*level.grid)));
  }
  return pieces;
}

// Of a fracture without meshes.
std::vector<Fragment> fromVolumes(const fs::path& folder) {
  const fs::path file = folder / kManifestName;
  const Manifest manifest = readManifest(file);
  if (!manifest.allVdb.empty()) return fromLevelSets(listedFile(file, manifest.allVdb));
  std::vector<fs::path> volumes;
  for (const ManifestFragment& fragment : manifest.fragments) {
    if (fragment.vdb.empty()) {
      inputError(file, "names neither meshes nor level sets of its fragments");
    }
    volumes.push_back(listedFile(file, fragment.vdb));
  }
  std::vector<Fragment> pieces(volumes.size());
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
    uncancelled([&] {
      pieces[i] = pieceOf(static_cast<int>(i) + 1, meshInWorld(*readLevelSet(volumes[i])));
    });
  });
  return pieces;
}

std::vector<Fragment> fromFolder(const fs::path& folder, const ReadOptions& options) {
  FragmentSet set = readFragments(folder, options);
  const bool hasMeshes = std::none_of(set.fragments.begin(), set.fragments.end(),
                                      [](const EvaluatedFragment& f) { return f.name.empty(); });
  if (!hasMeshes) return fromVolumes(folder);
  std::vector<Fragment> pieces;
  for (EvaluatedFragment& fragment : set.fragments) {
    FragmentMesh& mesh = fragment.mesh;
    pieces.push_back(pieceOf(mesh.id, std::move(mesh.mesh), std::move(mesh.facing)));
  }
  return pieces;
}

}  // namespace

std::vector<Fragment> readPieces(const fs::path& path, const ReadOptions& options) {
  requireSettled(path);
  const fs::file_type type = whatIsAt(path);
  if (type == fs::file_type::not_found) inputError(path, "no such file or folder");
  if (type == fs::file_type::directory) return fromFolder(path, options);
  const std::string extension = lowerCase(path.extension().string());
  if (extension == ".vdb") return fromLevelSets(path);
  if (extension == ".json") {
    (void)readManifest(path);
    const fs::path folder = path.parent_path();
    return fromFolder(folder.empty() ? "." : folder, options);
  }
  SourceMesh read = readMesh(path, options);
  std::vector<std::uint16_t> facing;
  if (extension == ".ply") facing = readFacing(path, read.mesh);
  std::vector<Fragment> pieces;
  pieces.push_back(pieceOf(1, std::move(read.mesh), std::move(facing)));
  return pieces;
}

}  // namespace sherd
