// Transfers surface attributes to the triangles of exact surfaces, which are known parts of the
// source's.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "appearance/transfer.h"
#include "appearance/weights.h"
#include "intersect/crossing_point.h"
#include "mesh/largest_axis.h"
#include "mesh/vertex_normals.h"

namespace sherd {
namespace {

constexpr int kNoCorner = -1;

// Projects a point along the coordinate axis that is nearest to a normal.
glm::vec2 projected(const glm::dvec3& p, const glm::dvec3& normal) {
  const int axis = largestAxis(normal);
  return {p[axis == 0 ? 1 : 0], p[axis == 2 ? 1 : 2]};
}

// A triangle that is a part of another.
struct Part {
  std::array<glm::dvec3, 3> corner{};   // positions
  std::array<int, 3> same{};            // the whole triangle's corner at the same position
  std::array<glm::dvec3, 3> weights{};  // barycentric, in the whole triangle
};

// Whether a part faces away from the whole triangle: repair flips triangles.
bool isFlipped(const Part& part, const std::array<glm::dvec3, 3>& whole) {
  const auto& same = part.same;
  if (same[0] != kNoCorner && same[1] != kNoCorner && same[2] != kNoCorner) {
    return same[1] != (same[0] + 1) % 3;
  }
  const int axis = largestAxis(glm::cross(whole[1] - whole[0], whole[2] - whole[0]));
  const auto sideOf = [&](const std::array<glm::dvec3, 3>& t) {
    return orientation(ExactPoint(t[0]), ExactPoint(t[1]), ExactPoint(t[2]), axis);
  };
  return sideOf(part.corner) * sideOf(whole) < 0;
}

// Whether a part stands across the whole triangle, as the rim of a shell does on its sheet.  A
// sliver in its plane does not, whatever its own normal.
bool isAcross(const Part& part, const std::array<glm::dvec3, 3>& whole) {
  const glm::dvec3 of = unitOrZero(glm::cross(whole[1] - whole[0], whole[2] - whole[0]));
  const double size = glm::length(whole[1] - whole[0]) + glm::length(whole[2] - whole[0]);
  const std::array<glm::dvec3, 3>& t = part.corner;
  const bool isInPlane = std::ranges::all_of(
      t, [&](const glm::dvec3& p) { return std::abs(glm::dot(p - whole[0], of)) <= 1e-6 * size; });
  constexpr double kLeastCosine = 0.1;
  return !isInPlane &&
         std::abs(glm::dot(unitOrZero(glm::cross(t[1] - t[0], t[2] - t[0])), of)) < kLeastCosine;
}

// Returns the unit vector of the mean of a triangle's normals; if they cancel, its own normal.
glm::vec3 between(const std::array<glm::vec3, 3>& normals, const glm::dvec3& weights,
                  const std::array<glm::dvec3, 3>& corner) {
  const glm::dvec3 mean = weights[0] * glm::dvec3(normals[0]) +
                          weights[1] * glm::dvec3(normals[1]) + weights[2] * glm::dvec3(normals[2]);
  if (glm::dot(mean, mean) > 0.0) return glm::vec3(glm::normalize(mean));
  return glm::vec3(unitOrZero(glm::cross(corner[1] - corner[0], corner[2] - corner[0])));
}

}  // namespace

SurfaceAttributes AttributeSource::fromSources(const TriangleMesh& mesh,
                                               std::uint32_t inside) const {
  SurfaceAttributes out = insideAttributes(mesh.triangles.size(), inside);
  if (!attributes_.normals.empty()) out.normals.resize(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, mesh.triangles.size(), [&](std::size_t t) {
    if (mesh.source[t] != TriangleMesh::kNoSource) return setFromSource(out, mesh, t);
    if (out.texcoords.empty()) return;
    const glm::dvec3 normal = cornersOf(mesh, mesh.triangles[t]).normal;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& p = mesh.vertices[mesh.triangles[t][static_cast<int>(k)]];
      out.texcoords[t][k] = projected(p, normal);
    }
  });
  return out;
}

// Sets the attributes of a triangle from the one that it is a part of.
void AttributeSource::setFromSource(SurfaceAttributes& out, const TriangleMesh& mesh,
                                    std::size_t t) const {
  const std::uint32_t from = mesh.source[t];
  if (!out.material.empty()) out.material[t] = attributes_.material[from];
  const glm::uvec3& s = mesh_.triangles[from];
  const std::array<glm::dvec3, 3> whole{mesh_.vertices[s.x], mesh_.vertices[s.y],
                                        mesh_.vertices[s.z]};
  Part part;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3& p = mesh.vertices[mesh.triangles[t][static_cast<int>(k)]];
    part.corner[k] = (p - center_) / scale_;  // to the bit, of a corner of the source
    const auto same = std::find(whole.begin(), whole.end(), part.corner[k]);
    part.same[k] = same == whole.end() ? kNoCorner : static_cast<int>(same - whole.begin());
    if (part.same[k] == kNoCorner) {
      part.weights[k] = weightsAt(part.corner[k], whole[0], whole[1], whole[2]);
    } else {
      part.weights[k][part.same[k]] = 1.0;
    }
    interpolate(out, t, k, from, part.weights[k]);
  }
  if (out.normals.empty() || isAcross(part, whole)) return;
  const float sign = isFlipped(part, whole) ? -1.0f : 1.0f;
  const auto& given = attributes_.normals[from];
  for (std::size_t k = 0; k < 3; ++k) {
    const int same = part.same[k];
    out.normals[t][k] = sign * (same == kNoCorner ? between(given, part.weights[k], whole)
                                                  : given[static_cast<std::size_t>(same)]);
  }
}

}  // namespace sherd
