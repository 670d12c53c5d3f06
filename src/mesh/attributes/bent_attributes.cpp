// Continues the attributes of triangles over their edges.
#include "mesh/attributes/bent_attributes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "mesh/triangle_area.h"

namespace sherd {
namespace {

// Thinner triangles do not determine what is beside them: height by longest edge.
constexpr double kLeastHeight = 0.01;

constexpr double kTextureError = 0.01, kColorError = 3.0;

std::array<glm::dvec3, 3> cornersAt(const TriangleMesh& mesh, std::uint32_t t) {
  return positionsOf(mesh.vertices, mesh.triangles[t]);
}

// The corner of a triangle that is not one of two positions; 3 if there is none.
std::size_t cornerBeside(const std::array<glm::dvec3, 3>& t, const glm::dvec3& a,
                         const glm::dvec3& b) {
  std::size_t k = 0;
  while (k < 3 && (t[k] == a || t[k] == b)) ++k;
  return k;
}

class Continuing {
 public:
  explicit Continuing(const SurfaceAttributes& attributes) : attributes_(attributes) {}

  // Whether the corner of another triangle has what the first one continues to there.
  //   weights  of the corner's position in the first triangle, adding up to 1
  bool isLinear(std::uint32_t first, std::uint32_t other, std::size_t corner,
                const glm::dvec3& weights) const {
    const double reach = std::abs(weights.x) + std::abs(weights.y) + std::abs(weights.z);
    if (!attributes_.texcoords.empty()) {
      const auto& uv = attributes_.texcoords[first];
      const glm::dvec2 at(attributes_.texcoords[other][corner]);
      glm::dvec2 expected(0.0);
      double range = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        expected += weights[static_cast<int>(k)] * glm::dvec2(uv[k]);
        range = std::max(range, glm::distance(glm::dvec2(uv[k]), at));
      }
      if (glm::distance(expected, at) > kTextureError * range) return false;
    }
    if (!attributes_.colors.empty()) {
      glm::dvec3 apart(attributes_.colors[other][corner]);
      for (std::size_t k = 0; k < 3; ++k)
        apart -= weights[static_cast<int>(k)] * glm::dvec3(attributes_.colors[first][k]);
      const double most = std::max({std::abs(apart.x), std::abs(apart.y), std::abs(apart.z)});
      if (most > kColorError * reach) return false;
    }
    return true;
  }

 private:
  const SurfaceAttributes& attributes_;
};

// The area beside seams in a plane where a chart meets itself.
double areaAtSlits(const TriangleMesh& mesh, const Charts& charts) {
  double area = 0.0;
  for (const Charts::Seam& seam : charts.seams) {
    if (charts.ids[seam.triangle[0]] != charts.ids[seam.triangle[1]]) continue;
    const glm::dvec3 a = areaNormal(cornersAt(mesh, seam.triangle[0])),
                     b = areaNormal(cornersAt(mesh, seam.triangle[1]));
    const double lengths = glm::length(a) * glm::length(b);
    if (lengths > 0.0 && glm::dot(a, b) >= kSamePlaneCosine * lengths)
      area += 0.5 * (glm::length(a) + glm::length(b));
  }
  return area;
}

}  // namespace

double bentArea(const TriangleMesh& mesh, const Charts& charts) {
  if (mesh.attributes.texcoords.empty() && mesh.attributes.colors.empty()) return 0.0;
  const Continuing continuing(mesh.attributes);
  double area = areaAtSlits(mesh, charts);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::array<glm::dvec3, 3> own = cornersAt(mesh, t);
    const glm::dvec3 normal = areaNormal(own);
    const double length = glm::length(normal);
    if (isThin(own, length, kLeastHeight)) continue;
    bool isBent = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t next = charts.neighbors[t][k];
      if (next == kNoTriangle) continue;
      const std::array<glm::dvec3, 3> other = cornersAt(mesh, next);
      const glm::dvec3 across = areaNormal(other);
      if (glm::dot(normal, across) < kSamePlaneCosine * length * glm::length(across)) continue;
      const std::size_t corner = cornerBeside(other, own[k], own[(k + 1) % 3]);
      if (corner == 3 || isThin(other, glm::length(across), kLeastHeight)) continue;
      glm::dvec3 weights;
      for (std::size_t i = 0; i < 3; ++i) {
        std::array<glm::dvec3, 3> part = own;
        part[i] = other[corner];
        weights[static_cast<int>(i)] = glm::dot(areaNormal(part), normal) / (length * length);
      }
      isBent = isBent || !continuing.isLinear(t, next, corner, weights);
    }
    if (isBent) area += 0.5 * length;
  }
  return area;
}

}  // namespace sherd
