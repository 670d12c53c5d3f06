// Leaves out small voids of the solid.
#include "remesh/parts/small_voids.h"

#include <sherd/solid.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "base/union_find.h"

namespace sherd {

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
    if (!all.mesh.neighbor.empty()) left.mesh.neighbor.push_back(all.mesh.neighbor[t]);
  }
  return left;
}

}  // namespace sherd
