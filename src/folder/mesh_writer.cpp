// Writes the meshes of a fracture with the surface attributes of the input mesh.
#include "folder/mesh_writer.h"

#include "appearance/source_faces.h"
#include "folder/file_names.h"
#include "folder/split_levels.h"
#include "folder/split_parents.h"
#include "formats/mesh/geo.h"
#include "formats/mesh/piece_mesh.h"
#include "formats/mesh/usd.h"
#include "formats/voxels/vdb_unit.h"

namespace sherd {

MeshWriter::MeshWriter(const OutputFolder& folder, const FractureFiles& files,
                       const SourceMesh& source, const MaterialTable& table,
                       const AttributeSource* attributes, const Solid& solid,
                       const WriteOptions& write, const CoordinateSystem& coordinates)
    : folder_(folder),
      table_(table),
      options_(write),
      coordinates_(coordinates),
      attributes_(attributes),
      solid_(solid),
      input_{source, groupNames(source)},
      library_(std::filesystem::path(files.materials).filename().string()),
      stem_(safeName(source.stem, "piece")) {
  if (files.mesh.empty() && files.scene.empty() && files.usd.empty()) return;
  if (!files.materials.empty()) (folder / files.materials).write(mtlText(table));
  for (std::size_t i = 0; i < files.textures.size(); ++i) {
    (folder / files.textures[i]).write(table.textures[i].bytes);
  }
}

SurfaceAttributes MeshWriter::attributesOf(const TriangleMesh& mesh) const {
  return attributes_ ? attributes_->transferTo(mesh, table_.inside()) : SurfaceAttributes();
}

std::vector<std::int32_t> MeshWriter::facesOf(const TriangleMesh& mesh) const {
  if (!attributes_ || !attributes_->findsTriangles()) return {};
  return sourceFaces(mesh, input_.source, *attributes_, solid_);
}

void MeshWriter::writeAs(MeshFileFormat format, const std::string& path,
                         const PieceMesh& piece) const {
  const OutputFile file = folder_ / path;
  if (options_.plainMeshes && format == MeshFileFormat::ply) {
    writePlainPly(file, piece.mesh, piece.isDouble);
  } else if (options_.plainMeshes && format == MeshFileFormat::obj) {
    writePlainObj(file, piece.mesh, piece.isDouble);
  } else if (options_.plainMeshes && format == MeshFileFormat::glb) {
    writePlainGlb(file, piece.name, piece.mesh, coordinates_);
  } else {
    writePiece(file, format, piece, library_);
  }
}

void MeshWriter::write(const TriangleMesh& mesh, const SurfaceAttributes& attributes,
                       const std::vector<std::string>& paths, bool isDouble) const {
  const std::string name = std::filesystem::path(paths.front()).stem().string();
  const std::vector<std::int32_t> faces = facesOf(mesh);
  const PieceMesh piece{name, mesh, attributes, table_, isDouble, &input_, faces, coordinates_};
  for (std::size_t i = 0; i < paths.size(); ++i) {
    writeAs(options_.meshFormats[i], paths[i], piece);
  }
}

void MeshWriter::write(const Fragment& fragment, const SurfaceAttributes& attributes,
                       const std::vector<std::string>& paths, bool isDouble,
                       const CopiedFiles& kept) const {
  const std::string name = std::filesystem::path(paths.front()).stem().string();
  const std::vector<std::int32_t> faces = facesOf(fragment.mesh);
  const PieceMesh piece{name,     fragment.mesh, attributes, table_,
                        isDouble, &input_,       faces,      coordinates_};
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (kept.copyMesh(fragment, paths[i], folder_)) continue;
    writeAs(options_.meshFormats[i], paths[i], piece);
  }
}

std::vector<std::string> MeshWriter::namesOf(std::span<const Fragment> fragments) const {
  std::vector<std::string> names;
  for (const Fragment& fragment : fragments) {
    names.push_back(fragmentName(stem_, static_cast<std::size_t>(fragment.id), fragments.size()));
  }
  return names;
}

FragmentScene MeshWriter::sceneOf(std::span<const Fragment> fragments,
                                  std::span<const SurfaceAttributes> attributes,
                                  std::span<const std::string> names, std::span<const Split> splits,
                                  const FractureFiles& files, double voxelSize) const {
  const SplitParents parents = parentsOf(splits, fragments.size());
  FragmentScene scene{.name = stem_,
                      .parentOfSplit = parents.ofSplit,
                      .textureFolder = "meshes/",
                      .density = options_.density,
                      .strength = options_.jointStrength,
                      .coordinates = coordinates_,
                      .plain = options_.plainMeshes};
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const Fragment& fragment = fragments[i];
    scene.pieces.push_back(
        {.id = fragment.id,
         .piece = {names[i], fragment.mesh, attributes[i], table_},
         .mass = fragment.mass,
         .contacts = fragment.contacts,
         .split = parents.ofFragment[static_cast<std::size_t>(fragment.id - 1)],
         .volume = options_.usdVolumes && !files.vdb.empty() ? files.vdb[i] : std::string(),
         .volumeUnit = vdbUnitOf(voxelSize, options_.vdbOptions.half)});
  }
  return scene;
}

void MeshWriter::writeScenes(std::span<const Fragment> fragments,
                             std::span<const SurfaceAttributes> attributes,
                             std::span<const Split> splits, const FractureFiles& files,
                             double voxelSize, const Progress* progress) const {
  const std::vector<std::string> names = namesOf(fragments);
  const FragmentScene scene = sceneOf(fragments, attributes, names, splits, files, voxelSize);
  if (!files.scene.empty()) writeSceneGlb(folder_ / files.scene, scene, progress);
  for (std::size_t i = 0; i < files.usd.size(); ++i) {
    const OutputFile file = folder_ / files.usd[i];
    if (options_.usdFormats[i] == UsdFormat::usda) writeUsda(file, scene, progress);
    if (options_.usdFormats[i] == UsdFormat::usdz) writeUsdz(file, scene, progress);
  }
}

void MeshWriter::writeHoudini(std::span<const Fragment> fragments,
                              std::span<const SurfaceAttributes> attributes,
                              std::span<const Split> splits, const std::string& path,
                              const Progress* progress) const {
  const std::vector<UnrealCluster> clusters =
      unrealClusters(SplitLevels(parentsOf(splits, fragments.size())), fragments);
  const std::vector<std::string> names = namesOf(fragments);
  std::vector<GeoPiece> pieces;
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    pieces.push_back({.id = fragments[i].id,
                      .piece = {names[i], fragments[i].mesh, attributes[i], table_},
                      .level = clusters[i].level,
                      .cluster = clusters[i].cluster});
  }
  writeGeo(folder_ / path, pieces, progress);
}

}  // namespace sherd
