// Coarser meshes for previews, by clustering vertices in cubes.
#include "render/preview_fragment.h"

#include <sherd/fracture.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "pipeline/memory_estimate.h"

namespace sherd {
namespace {

// Index of the cube that contains a point, 21 bits per axis; kPreviewCubes needs ten.
std::uint64_t cubeOf(const glm::dvec3& p, const glm::dvec3& low, double cell) {
  std::uint64_t cube = 0;
  for (int axis = 0; axis < 3; ++axis) {
    cube = cube << 21 | static_cast<std::uint64_t>((p[axis] - low[axis]) / cell);
  }
  return cube;
}

}  // namespace

Fragment previewFragment(const Fragment& fragment, const Solid& solid) {
  constexpr double kLeastVoxels = 1.25;  // per cube side; below, most cubes hold one vertex
  const TriangleMesh& mesh = fragment.mesh;
  Fragment out;
  out.id = fragment.id;
  out.mass = fragment.mass;
  const double voxels = solid.box.longestSide() / kPreviewCubes;  // per cube side
  if (voxels < kLeastVoxels) {
    out.mesh = mesh;
    return out;
  }
  const double cell = voxels * solid.frame.voxelSize;
  const glm::dvec3 low = bounds(mesh).min;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> byCube;
  byCube.reserve(mesh.vertices.size());
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    byCube.emplace_back(cubeOf(mesh.vertices[v], low, cell), v);
  }
  std::sort(byCube.begin(), byCube.end());
  std::vector<std::uint32_t> number(mesh.vertices.size());
  for (std::size_t first = 0, end = 0; first < byCube.size(); first = end) {
    glm::dvec3 sum(0.0);
    for (; end < byCube.size() && byCube[end].first == byCube[first].first; ++end) {
      number[byCube[end].second] = static_cast<std::uint32_t>(out.mesh.vertices.size());
      sum += mesh.vertices[byCube[end].second];
    }
    out.mesh.vertices.push_back(sum / static_cast<double>(end - first));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& old = mesh.triangles[t];
    const glm::uvec3 corner(number[old.x], number[old.y], number[old.z]);
    if (corner.x == corner.y || corner.y == corner.z || corner.z == corner.x) continue;
    out.mesh.triangles.push_back(corner);
    if (!mesh.neighbor.empty()) out.mesh.neighbor.push_back(mesh.neighbor[t]);
  }
  return out;
}

}  // namespace sherd
