// Writes the meshes of a fracture with the surface attributes of the input mesh.
#include "folder/files/mesh_writer.h"

#include <algorithm>
#include <utility>

#include "appearance/source_faces.h"
#include "folder/files/split_levels.h"
#include "folder/manifest/file_names.h"
#include "folder/manifest/split_parents.h"
#include "formats/geo/geo.h"
#include "formats/gltf/glb.h"
#include "formats/mesh/piece_mesh.h"
#include "formats/mesh_files/write_mesh.h"
#include "formats/obj/obj.h"
#include "formats/ply/ply.h"
#include "formats/usd/usd.h"
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

MeshWriter::Levels MeshWriter::levelsOf(std::span<const Fragment> fragments) const {
  const std::size_t count = fragments.empty() ? 0 : fragments.front().coarse.size();
  const auto trianglesOf = [&](std::size_t level) {
    std::size_t all = 0;
    for (const Fragment& own : fragments) {
      all += (level < count ? own.coarse[level] : own.mesh).triangles.size();
    }
    return all;
  };
  std::vector<std::pair<std::size_t, std::size_t>> sizes;  // triangles of all, level
  for (std::size_t k = 0; k < count; ++k) sizes.emplace_back(trianglesOf(k), k);
  std::sort(sizes.rbegin(), sizes.rend());
  Levels levels;
  levels.meshes.resize(fragments.size());
  levels.attributes.resize(fragments.size());
  std::size_t last = trianglesOf(count);
  for (const auto& [triangles, level] : sizes) {
    if (triangles >= last) continue;
    last = triangles;
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      levels.meshes[i].push_back(&fragments[i].coarse[level]);
      levels.attributes[i].push_back(attributesOf(fragments[i].coarse[level]));
    }
  }
  return levels;
}

FragmentScene MeshWriter::sceneOf(std::span<const Fragment> fragments,
                                  std::span<const SurfaceAttributes> attributes,
                                  std::span<const std::string> names, const Levels& levels,
                                  std::span<const Split> splits, const FractureFiles& files,
                                  double voxelSize) const {
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
    std::vector<PieceMesh> coarse;
    for (std::size_t k = 0; k < levels.meshes[i].size(); ++k) {
      coarse.push_back({names[i], *levels.meshes[i][k], levels.attributes[i][k], table_});
    }
    scene.pieces.push_back(
        {.id = fragment.id,
         .piece = {names[i], fragment.mesh, attributes[i], table_},
         .coarse = std::move(coarse),
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
  const Levels levels = levelsOf(fragments);
  const FragmentScene scene =
      sceneOf(fragments, attributes, names, levels, splits, files, voxelSize);
  if (!files.scene.empty()) writeSceneGlb(folder_ / files.scene, scene, progress);
  for (std::size_t i = 0; i < files.usd.size(); ++i) {
    const OutputFile file = folder_ / files.usd[i];
    if (options_.usdFormats[i] == UsdFormat::usda) writeUsda(file, scene, progress);
    if (options_.usdFormats[i] == UsdFormat::usdz) writeUsdz(file, scene, progress);
  }
}

void MeshWriter::writeHoudini(std::span<const Fragment> fragments,
                              std::span<const SurfaceAttributes> attributes,
                              std::span<const Split> splits, const std::vector<std::string>& paths,
                              const Progress* progress) const {
  const std::vector<UnrealCluster> clusters =
      unrealClusters(SplitLevels(parentsOf(splits, fragments.size())), fragments);
  const std::vector<std::string> names = namesOf(fragments);
  for (std::size_t file = 0; file < paths.size(); ++file) {
    std::vector<SurfaceAttributes> ofCoarse;
    for (const Fragment& fragment : fragments) {
      if (file > 0) ofCoarse.push_back(attributesOf(fragment.coarse[file - 1]));
    }
    std::vector<GeoPiece> pieces;
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      const TriangleMesh& mesh = file == 0 ? fragments[i].mesh : fragments[i].coarse[file - 1];
      pieces.push_back({.id = fragments[i].id,
                        .piece = {names[i], mesh, file == 0 ? attributes[i] : ofCoarse[i], table_},
                        .level = clusters[i].level,
                        .cluster = clusters[i].cluster});
    }
    writeGeo(folder_ / paths[file], pieces, progress, options_.plainMeshes);
  }
}

}  // namespace sherd
