// Reduces the labels to two: the fragment, and kEroded for all others.
#include "interface/independent_mesh.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "base/union_find.h"
#include "interface/interface_mesh.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

// The fragment's distances to the cut, and the negated ones for kEroded.
CutLeaf bothSides(const CutLeaf& cut, std::uint16_t fragment) {
  CutLeaf both{{1, Labels::kEroded}, {}};
  if (cut.distance.empty()) return both;
  const auto at = std::lower_bound(cut.fragments.begin(), cut.fragments.end(), fragment);
  const auto ownDistance = cut.distance.begin() + (at - cut.fragments.begin()) * 512;
  both.distance.assign(ownDistance, ownDistance + 512);
  for (std::size_t v = 0; v < 512; ++v) both.distance.push_back(-both.distance[v]);
  return both;
}

// Removes what encloses a void of the solid of less than kSmallComponentVoxels, as where two bones
// of a skeleton touch: a few triangles inside the fragment, mostly of less than a voxel.
LabeledMesh withoutSmallVoids(LabeledMesh all, double voxelSize) {
  UnionFind surfaces(all.mesh.vertices.size());
  for (const glm::uvec3& t : all.mesh.triangles) {
    surfaces.unite(t.x, t.y);
    surfaces.unite(t.x, t.z);
  }
  const std::vector<std::uint32_t> surfaceOf = std::move(surfaces).all();
  if (std::all_of(surfaceOf.begin(), surfaceOf.end(), [&](auto s) { return s == surfaceOf[0]; })) {
    return all;
  }
  std::vector<double> sixfold(surfaceOf.size(), 0.0);  // volume, by surface
  std::vector<bool> isOfSolid(surfaceOf.size(), true);
  for (std::size_t t = 0; t < all.other.size(); ++t) {
    const glm::uvec3& corner = all.mesh.triangles[t];
    const std::uint32_t s = surfaceOf[corner.x];
    const glm::dvec3& from = all.mesh.vertices[s];
    sixfold[s] += glm::dot(
        all.mesh.vertices[corner.x] - from,
        glm::cross(all.mesh.vertices[corner.y] - from, all.mesh.vertices[corner.z] - from));
    if (all.other[t] != 0) isOfSolid[s] = false;
  }
  const double most =
      6.0 * static_cast<double>(kSmallComponentVoxels) * voxelSize * voxelSize * voxelSize;
  const auto isVoid = [&](std::uint32_t s) {
    return isOfSolid[s] && sixfold[s] < 0.0 && -sixfold[s] < most;
  };
  LabeledMesh left;
  std::vector<std::uint32_t> number(surfaceOf.size(), 0);
  for (std::size_t v = 0; v < surfaceOf.size(); ++v) {
    if (isVoid(surfaceOf[v])) continue;
    number[v] = static_cast<std::uint32_t>(left.mesh.vertices.size());
    left.mesh.vertices.push_back(all.mesh.vertices[v]);
    left.positionId.push_back(all.positionId[v]);
  }
  for (std::size_t t = 0; t < all.other.size(); ++t) {
    const glm::uvec3& corner = all.mesh.triangles[t];
    if (isVoid(surfaceOf[corner.x])) continue;
    left.mesh.triangles.emplace_back(number[corner.x], number[corner.y], number[corner.z]);
    left.other.push_back(all.other[t]);
  }
  return left;
}

}  // namespace

LabeledMesh meshOfOne(const Solid& solid, const Labels& labels, const Cut& cut,
                      const Creases& creases, std::uint16_t fragment,
                      std::span<const std::uint32_t> leaves) {
  Solid reduced;
  reduced.frame = solid.frame;
  reduced.distance = solid.distance;
  reduced.region = solid.region;
  LeafBlocks blocks;
  Labels twoLabels;
  Cut ownCut;
  ownCut.snapWeight.resize(std::size_t{Labels::kEroded} + 1);
  ownCut.snapWeight[1] = cut.snapWeight[fragment];
  for (const std::uint32_t leaf : leaves) {
    const auto from = static_cast<std::ptrdiff_t>(leaf);
    const auto inside = solid.blocks->inside.begin() + from * 8;
    blocks.origins.push_back(solid.blocks->origins[leaf]);
    blocks.inside.insert(blocks.inside.end(), inside, inside + 8);
    std::transform(labels.fragment.begin() + from * 512, labels.fragment.begin() + (from + 1) * 512,
                   std::back_inserter(twoLabels.fragment), [&](std::uint16_t label) {
                     return label == fragment ? std::uint16_t{1} : Labels::kEroded;
                   });
    const bool isWhole = cut.index[leaf] == Cut::kWhole;
    ownCut.only.push_back(isWhole ? 1 : 0);
    ownCut.index.push_back(isWhole ? Cut::kWhole
                                   : static_cast<std::uint32_t>(ownCut.leaves.size()));
    if (!isWhole) ownCut.leaves.push_back(bothSides(cut.leaves[cut.index[leaf]], fragment));
  }
  const std::vector<LeafNeighbors> neighborhoods = leafNeighbors(blocks.origins);
  reduced.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  twoLabels.blocks = reduced.blocks;
  twoLabels.fragmentCount = 1;
  const InterfaceSurface surface(reduced, twoLabels, ownCut, neighborhoods, creases, nullptr,
                                 SurfaceVertices::all, nullptr);
  return withoutSmallVoids(InterfaceMeshes(surface, neighborhoods, nullptr).meshOf(1),
                           solid.frame.voxelSize);
}

}  // namespace sherd
