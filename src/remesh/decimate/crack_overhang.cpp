// Tests the ends of cracks against the mesh that they are to cut.
#include "remesh/decimate/crack_overhang.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>

#include "intersect/self_crossings.h"
#include "mesh/search/boxes.h"

namespace sherd {

bool CrackOverhang::mayMove(const glm::dvec3& from, const glm::dvec3& to,
                            const glm::dvec3& end) const {
  return !meets(from, to, end) && !isNear(to, end);
}

bool CrackOverhang::meets(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) const {
  for (const std::uint32_t near : tree_.meeting(boxOf({a, b, c}))) {
    const auto [p, q, r] = tree_.corners(near);
    if (trianglesCross(std::array{a, b, c, p, q, r}, {0, 1, 2}, {3, 4, 5})) return true;
  }
  return false;
}

bool CrackOverhang::isNear(const glm::dvec3& from, const glm::dvec3& to) const {
  // Between two points of the segment it is no nearer than this share of their distance.
  constexpr double kReach = 2.0 * kLeastOverhang, kStep = 3.0 * kLeastOverhang;
  const auto steps = static_cast<int>(std::ceil(glm::distance(from, to) / kStep)) + 1;
  for (int i = 0; i <= steps; ++i) {
    const glm::dvec3 p = from + (static_cast<double>(i) / steps) * (to - from);
    if (tree_.nearest(p, kReach).triangle != TriangleTree::kNone) return true;
  }
  return false;
}

}  // namespace sherd
