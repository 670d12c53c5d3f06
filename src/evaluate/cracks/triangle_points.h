// Points on triangles.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

namespace sherd {

/// Returns points spread evenly over a triangle, at most `spacing` apart; 1 to 136.
[[nodiscard]] std::vector<glm::dvec3> pointsOn(const std::array<glm::dvec3, 3>& triangle,
                                               double spacing);

}  // namespace sherd
