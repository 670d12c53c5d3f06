// Triangulation of a face with vertices on its sides.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// Orders positions by x, then y, then z.
[[nodiscard]] inline bool isBefore(const glm::dvec3& a, const glm::dvec3& b) {
  for (int k = 0; k < 3; ++k) {
    if (a[k] != b[k]) return a[k] < b[k];
  }
  return false;
}

/// A vertex on the boundary of a face, with bits of the sides that it is on: two for a corner.
struct RingPoint {
  std::uint32_t vertex = 0;
  unsigned sides = 0;
};

/// The vertices around a face, counter-clockwise.
using FaceRing = std::vector<RingPoint>;

/// Triangulates a face by diagonals of the least cost in all.  Depends on nothing but positions:
/// seen from the other side the triangles are the same.
///   ring    at least three points
///   cost    of a diagonal, > 0; its first end is the first one by isBefore
///   return  corners of triangles as indices of the ring, counter-clockwise
///   source  Klincsek, Minimal Triangulations of Polygonal Domains, 1980
[[nodiscard]] std::vector<std::array<std::size_t, 3>> triangulated(
    const FaceRing& ring, std::span<const glm::dvec3> vertices,
    const std::function<double(const glm::dvec3&, const glm::dvec3&)>& cost);

}  // namespace sherd
