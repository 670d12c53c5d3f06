// Exact positions of vertices, crossings and others.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <memory>

namespace sherd {

struct HomogeneousPoint;

/// A given vertex, the point where an edge crosses a triangle, or any other exact position.  Its
/// exact coordinates are within `error` of rounded + rest.
struct ExactPoint {
  glm::dvec3 rounded{0.0};  ///< the exact coordinates, rounded to nearest
  glm::dvec3 rest{0.0};
  glm::dvec3 error{0.0};
  bool isVertex = true;                                ///< then `rounded` is exact
  std::array<glm::dvec3, 2> edge{};                    ///< of a crossing
  std::array<glm::dvec3, 3> corner{};                  ///< of a crossing: of its triangle
  std::shared_ptr<const HomogeneousPoint> position{};  ///< of neither a vertex nor a crossing

  ExactPoint() = default;
  explicit ExactPoint(const glm::dvec3& vertex) : rounded(vertex) {}
};

}  // namespace sherd
