// Noise on points that are sampled of fragments' surfaces.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <vector>

#include "base/cancel_flag.h"
#include "mesh/triangle_area.h"
#include "surface/boundary_distance.h"
#include "surface/fragment_surfaces.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNoNumber = 0xffffffffu;

}  // namespace

std::array<std::uint32_t, 3> FragmentSurfaces::verticesOf(std::uint16_t id,
                                                          const TriangleIndex& of) const {
  if (of.quad == nullptr) return surface_.gapsOf(id)[of.i]->vertex;
  return trianglesOf(of.quad->vertex, of.quad->split)[of.i];
}

// Distances are linear in a triangle, so that their gradient follows from those of its corners; in
// one without height it may be steeper than a distance is.
SlopedValue FragmentSurfaces::toBoundary(std::uint16_t id, const TriangleIndex& of,
                                         const std::array<double, 3>& shares) const {
  const std::array<std::uint32_t, 3> vertex = verticesOf(id, of);
  std::array<glm::dvec3, 3> at;
  std::array<double, 3> distance;
  for (std::size_t k = 0; k < 3; ++k) {
    at[k] = frame_.indexFromWorld(surface_.vertices().at[vertex[k]]);
    distance[k] = toBoundary_[vertex[k]];
  }
  const glm::dvec3 across = areaNormal(at);
  SlopedValue sum;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 opposite = at[(k + 2) % 3] - at[(k + 1) % 3];
    sum.value += shares[k] * distance[k];
    sum.gradient += distance[k] * glm::cross(across, opposite) / glm::dot(across, across);
  }
  const double steepness = glm::length(sum.gradient);
  if (steepness > 1.0) sum.gradient /= steepness;
  return sum;
}

std::function<void(std::size_t, std::size_t, const std::array<double, 3>&, SurfacePoint&)>
FragmentSurfaces::displacementOf(std::uint16_t id, const std::vector<Part>& own) const {
  return [this, id, own, noise = noise_->ofPoints(id)](std::size_t part, std::size_t t,
                                                       const std::array<double, 3>& shares,
                                                       SurfacePoint& point) {
    SlopedValue distance;
    if (point.neighbor != 0 && !toBoundary_.empty()) {
      const bool isGap = part == own.size();
      distance = toBoundary(
          id, isGap ? TriangleIndex{nullptr, t} : TriangleIndex{own[part].quads + t / 2, t % 2},
          shares);
    }
    noise.move(point, distance);
  };
}

void FragmentSurfaces::displacePoints(const SurfaceNoise& noise, const Progress* progress) {
  if (!noise.isAny()) return;
  noise_ = noise;
  const double most = noise.fadeVoxels();
  if (most == 0.0) return;
  toBoundary_.assign(surface_.vertices().at.size(), most);
  std::vector<std::uint32_t> numbers(toBoundary_.size(), kNoNumber);  // a vertex is of one fragment
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{1}, count_ + 1, [&](std::size_t id) {
    if (!stop.isSet()) findDistances(static_cast<std::uint16_t>(id), most, numbers);
  });
  stop.throwIfSet();
}

// No quad of a crack has a vertex of an intact one, so those are left out.
void FragmentSurfaces::findDistances(std::uint16_t id, double most,
                                     std::vector<std::uint32_t>& numbers) {
  TriangleMesh mesh;
  std::vector<std::uint32_t> vertices;  // [mesh.vertices]
  const auto numberOf = [&](std::uint32_t v) {
    if (numbers[v] == kNoNumber) {
      numbers[v] = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back(v);
      mesh.vertices.push_back(surface_.vertices().at[v]);
    }
    return numbers[v];
  };
  const auto add = [&](const std::array<std::uint32_t, 3>& vertex, std::uint16_t neighbor) {
    mesh.triangles.emplace_back(numberOf(vertex[0]), numberOf(vertex[1]), numberOf(vertex[2]));
    mesh.neighbor.push_back(neighbor);
  };
  for (const std::uint32_t leaf : surface_.leavesOf(id)) {
    for (const InterfaceQuad& quad : surface_.quadsOf(leaf, id)) {
      if (quad.isIntact) continue;
      const QuadHalves halves = trianglesOf(quad.vertex, quad.split);
      for (const std::size_t half : {0, 1}) add(halves[half], neighborOf(leaf, quad, half));
    }
  }
  for (std::size_t i = 0; i < surface_.gapsOf(id).size(); ++i)
    add(surface_.gapsOf(id)[i]->vertex, gap(id, i).neighbor);
  const std::vector<double> distance =
      boundaryDistances(mesh, contactsOf(mesh), frame_.voxelSize, most);
  for (std::size_t v = 0; v < vertices.size(); ++v)
    toBoundary_[vertices[v]] = std::min(distance[v], most);
}

}  // namespace sherd
