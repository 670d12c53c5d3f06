// The colors of fragments, tone mapping and sRGB encoding.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

namespace sherd {

/// Diffuse reflectance of one fragment, linear sRGB.
struct FragmentColor {
  glm::vec3 outer{0.0f};  ///< original surface
  glm::vec3 inner{0.0f};  ///< fracture surface: lighter and paler, like the core of a potsherd
};

/// Returns the color of fragment n >= 0.  Hues are a golden angle apart, which keeps any number of
/// fragments distinct.
[[nodiscard]] FragmentColor fragmentColor(int n);

/// Compresses highlights: identity up to 0.7, then smoothly towards 1.
[[nodiscard]] glm::vec3 toneMap(glm::vec3 light);

/// Returns the sRGB byte of a linear value, clamped to 0..1.
[[nodiscard]] std::uint8_t byteFromLinear(float value);

/// Returns the sRGB value 0..1 of a linear value, clamped to 0..1.
[[nodiscard]] float srgbFromLinear(float value);

/// Returns the linear value of an sRGB value 0..1.
[[nodiscard]] float linearFromSrgb(float value);

}  // namespace sherd
