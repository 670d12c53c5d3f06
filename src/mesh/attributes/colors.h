// Conversion of colors from files.
#pragma once

#include <glm/gtc/type_precision.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// Returns 8-bit colors from numbers in 0..1, or in 0..255 if any is above 1; clamps values
/// outside.
[[nodiscard]] std::vector<glm::u8vec3> colorsFrom(std::span<const glm::vec3> numbers);

}  // namespace sherd
