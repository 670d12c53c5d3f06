// Conversion of colors from files and between sRGB and linear, and detection of image types.
#include "mesh/attributes/colors.h"

#include <sherd/mesh.h>

#include <algorithm>
#include <cmath>

namespace sherd {
namespace {

// Returns 0 for NaN.
std::uint8_t byteOf(float value) {
  return value > 0.0f ? static_cast<std::uint8_t>(std::min(value, 1.0f) * 255.0f + 0.5f)
                      : std::uint8_t{0};
}

}  // namespace

std::vector<glm::u8vec3> colorsFrom(std::span<const glm::vec3> numbers) {
  const bool bytes = std::any_of(numbers.begin(), numbers.end(), [](const glm::vec3& c) {
    return c.x > 1.0f || c.y > 1.0f || c.z > 1.0f;
  });
  const float scale = bytes ? 1.0f / 255.0f : 1.0f;
  std::vector<glm::u8vec3> colors;
  colors.reserve(numbers.size());
  for (const glm::vec3& c : numbers) {
    colors.emplace_back(byteOf(c.x * scale), byteOf(c.y * scale), byteOf(c.z * scale));
  }
  return colors;
}

ImageType imageType(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return ImageType::png;
  if (bytes.starts_with("\xff\xd8\xff")) return ImageType::jpeg;
  return ImageType::other;
}

// source  IEC 61966-2-1
glm::vec3 linearFromSrgb(glm::u8vec3 color) {
  glm::vec3 linear;
  for (int i = 0; i < 3; ++i) {
    const float c = static_cast<float>(color[i]) / 255.0f;
    linear[i] = c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
  }
  return linear;
}

glm::u8vec3 srgbFromLinear(glm::vec3 color) {
  glm::u8vec3 srgb;
  for (int i = 0; i < 3; ++i) {
    const float c = color[i];
    srgb[i] = byteOf(c <= 0.0031308f ? c * 12.92f : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f);
  }
  return srgb;
}

}  // namespace sherd
