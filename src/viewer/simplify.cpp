// Coarser meshes for a page that has to stay small.
#include "viewer/simplify.h"

#include <algorithm>
#include <cstddef>

namespace sherd {
namespace {

constexpr int kBits = 10;  // of a cube's number along an axis
constexpr std::size_t kFewestTriangles = 8;

void keep(ClusteredVertices::Mesh& to, const ViewerPiece& from, std::size_t triangle,
          const glm::uvec3& corners) {
  to.mesh.triangles.push_back(corners);
  if (!from.mesh->neighbor.empty()) to.mesh.neighbor.push_back(from.mesh->neighbor[triangle]);
  if (from.attributes == nullptr) return;
  const SurfaceAttributes& own = *from.attributes;
  if (!own.texcoords.empty()) to.attributes.texcoords.push_back(own.texcoords[triangle]);
  if (!own.colors.empty()) to.attributes.colors.push_back(own.colors[triangle]);
  if (!own.material.empty()) to.attributes.material.push_back(own.material[triangle]);
}

}  // namespace

ClusteredVertices::ClusteredVertices(const std::vector<ViewerPiece>& pieces, const Box& box,
                                     int cubes)
    : low_(box.min), side_(std::max(longestSide(box), 1e-300) / cubes) {
  std::vector<std::uint32_t> all;
  for (const ViewerPiece& piece : pieces) {
    if (piece.mesh == nullptr) continue;
    for (const glm::dvec3& vertex : piece.mesh->vertices) all.push_back(cubeOf(vertex));
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  cubes_ = std::move(all);
  // A vertex that several pieces share counts once for each; all of them see the same mean.
  means_.assign(cubes_.size(), glm::dvec3(0.0));
  std::vector<double> count(cubes_.size(), 0.0);
  for (const ViewerPiece& piece : pieces) {
    if (piece.mesh == nullptr) continue;
    for (const glm::dvec3& vertex : piece.mesh->vertices) {
      const auto at = static_cast<std::size_t>(std::ranges::lower_bound(cubes_, cubeOf(vertex)) -
                                               cubes_.begin());
      means_[at] += vertex - low_;
      count[at] += 1.0;
    }
  }
  for (std::size_t i = 0; i < means_.size(); ++i) means_[i] = low_ + means_[i] / count[i];
}

std::uint32_t ClusteredVertices::cubeOf(const glm::dvec3& position) const {
  std::uint32_t cube = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = std::clamp((position[axis] - low_[axis]) / side_, 0.0, kMostCubes - 1.0);
    cube = cube << kBits | static_cast<std::uint32_t>(along);
  }
  return cube;
}

ClusteredVertices::Mesh ClusteredVertices::of(const ViewerPiece& piece) const {
  const TriangleMesh& mesh = *piece.mesh;
  std::vector<std::uint32_t> own(mesh.vertices.size());
  std::ranges::transform(mesh.vertices, own.begin(),
                         [&](const glm::dvec3& v) { return cubeOf(v); });
  std::vector<std::uint32_t> used = own;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto indexIn = [](const std::vector<std::uint32_t>& list, std::uint32_t cube) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(list, cube) - list.begin());
  };
  Mesh result;
  result.mesh.isMerged = mesh.isMerged;
  for (const std::uint32_t cube : used) {
    result.mesh.vertices.push_back(means_[indexIn(cubes_, cube)]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& old = mesh.triangles[t];
    const glm::uvec3 corner(own[old.x], own[old.y], own[old.z]);
    if (corner.x == corner.y || corner.y == corner.z || corner.z == corner.x) continue;
    keep(result, piece, t,
         {indexIn(used, corner.x), indexIn(used, corner.y), indexIn(used, corner.z)});
  }
  if (result.mesh.triangles.size() >= kFewestTriangles) return result;
  return {mesh, piece.attributes == nullptr ? SurfaceAttributes{} : *piece.attributes};
}

}  // namespace sherd
