// Meshes of exact surfaces, as faces of all pieces together and back.
#include "remesh/parts/clean_meshes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "mesh/positions.h"
#include "mesh/single_rounding.h"
#include "remesh/manifold.h"
#include "remesh/vertex_numbers.h"

namespace sherd {
namespace {

// The vertices and faces of all pieces, as one.
struct Joined {
  CleanMesh mesh;
  std::vector<std::uint32_t> positionId;  // [vertices] ascending
  std::vector<bool> hasSheets;            // [pieces] several of its vertices are at one position
};

// Returns [positions] the vertices by LabeledMesh::positionId, of which some are not used.
std::vector<glm::dvec3> positionsOf(const std::vector<LabeledMesh>& meshes,
                                    std::vector<std::uint32_t>& used) {
  std::uint32_t end = 0;
  for (const LabeledMesh& mesh : meshes) {
    used.insert(used.end(), mesh.positionId.begin(), mesh.positionId.end());
    for (const std::uint32_t id : mesh.positionId) end = std::max(end, id + 1);
  }
  std::vector<glm::dvec3> at(end);
  for (const LabeledMesh& mesh : meshes) {
    for (std::size_t v = 0; v < mesh.positionId.size(); ++v) {
      at[mesh.positionId[v]] = mesh.mesh.vertices[v];
    }
  }
  return at;
}

// Returns the positions that several vertices of a mesh are at, ascending.
template <class PositionOf>
std::vector<std::uint32_t> repeated(const LabeledMesh& mesh, const PositionOf& positionOf) {
  std::vector<std::uint32_t> at, twice;
  for (std::uint32_t v = 0; v < mesh.positionId.size(); ++v) at.push_back(positionOf(v));
  std::sort(at.begin(), at.end());
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (at[i] == at[i - 1] && (twice.empty() || twice.back() != at[i])) twice.push_back(at[i]);
  }
  return twice;
}

Joined joined(const std::vector<LabeledMesh>& meshes, const TriangleMesh& cut) {
  Joined all;
  std::vector<std::uint32_t> used;
  const std::vector<glm::dvec3> at = positionsOf(meshes, used);
  const VertexNumbers numbers(std::move(used), at.size());
  for (const std::uint32_t id : numbers.vertices()) {
    all.positionId.push_back(id);
    all.mesh.vertices.push_back(at[id]);
    all.mesh.isFixed.push_back(id < cut.vertices.size());
  }
  const std::vector<std::uint32_t> first = firstAtPosition(all.mesh.vertices);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const LabeledMesh& own = meshes[i];
    const auto vertex = [&](std::uint32_t v) { return first[numbers.of(own.positionId[v])]; };
    const std::vector<std::uint32_t> shared = repeated(own, vertex);
    all.hasSheets.push_back(!shared.empty());
    for (const std::uint32_t v : shared) {
      all.mesh.pinches.push_back({static_cast<std::uint16_t>(i + 1), v});
    }
    for (std::size_t t = 0; t < own.mesh.triangles.size(); ++t) {
      const glm::uvec3& c = own.mesh.triangles[t];
      all.mesh.faces.push_back({{vertex(c.x), vertex(c.y), vertex(c.z)},
                                static_cast<std::uint16_t>(i + 1),
                                own.other[t],
                                own.mesh.source[t]});
    }
  }
  return all;
}

// Returns the mesh of a piece.
//   faces  its own
LabeledMesh meshOf(const std::vector<CleanFace>& faces, const CleanMesh& all,
                   const std::vector<std::uint32_t>& positionId) {
  std::vector<std::uint32_t> used;
  for (const CleanFace& f : faces) used.insert(used.end(), {f.corner.x, f.corner.y, f.corner.z});
  const VertexNumbers numbers(std::move(used), all.vertices.size());
  LabeledMesh out;
  for (const std::uint32_t v : numbers.vertices()) {
    out.positionId.push_back(positionId[v]);
    out.mesh.vertices.push_back(all.vertices[v]);
  }
  for (const CleanFace& f : faces) {
    out.mesh.triangles.emplace_back(numbers.of(f.corner.x), numbers.of(f.corner.y),
                                    numbers.of(f.corner.z));
    out.other.push_back(f.other);
    out.mesh.source.push_back(f.source);
  }
  return out;
}

}  // namespace

CleanOptions cleanOptions(const Solid& solid) {
  const double voxel = solid.frame.voxelSize;
  const double side = solid.box.longestSide() * voxel;
  const double spacing = 2.0 * singleRounding({solid.frame.worldFromIndex(solid.box.min),
                                               solid.frame.worldFromIndex(solid.box.max)});
  CleanOptions options{.tolerance = std::max(kCleanVoxels * voxel, kCleanShare * side)};
  if (spacing / 2.0 > kCleanRoundingVoxels * voxel) return options;
  options.tolerance = std::max(options.tolerance, kCleanSpacings * spacing);
  options.spacing = spacing;
  return options;
}

std::vector<LabeledMesh> withoutSlivers(std::vector<LabeledMesh> meshes, const TriangleMesh& cut,
                                        const CleanOptions& options, const Progress* progress) {
  Joined all = joined(meshes, cut);
  const Cleaned clean = cleaned(std::move(all.mesh), cut, options, progress);
  if (clean.changes == 0) return meshes;
  while (all.positionId.size() < clean.mesh.vertices.size()) {  // new ones
    all.positionId.push_back(all.positionId.back() + 1);
  }
  std::vector<std::vector<CleanFace>> faces(meshes.size());
  for (const CleanFace& f : clean.mesh.faces) faces[f.piece - 1u].push_back(f);
  tbb::parallel_for(std::size_t{0}, meshes.size(), [&](std::size_t i) {
    meshes[i] = meshOf(faces[i], clean.mesh, all.positionId);
    if (all.hasSheets[i]) (void)makeManifold(meshes[i]);  // it is closed, as it was
  });
  return meshes;
}

}  // namespace sherd
