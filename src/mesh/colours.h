// Colours as files have them.
#pragma once

#include <glm/gtc/type_precision.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// Colours told as numbers, 0..1, or 0..255 where one is above 1; what is outside is clamped.
[[nodiscard]] std::vector<glm::u8vec3> coloursFrom(std::span<const glm::vec3> numbers);

}  // namespace sherd
