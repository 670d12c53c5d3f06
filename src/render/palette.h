// The colours of fragments, and how light becomes an 8-bit picture.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

namespace sherd {

/// Diffuse reflectance of one fragment, linear sRGB.
struct PieceColour {
  glm::vec3 outer{0.0f};  ///< original surface
  glm::vec3 inner{0.0f};  ///< fracture surface: lighter and paler, as a potsherd's core
};

/// The colour of the n-th fragment, n >= 0: hues a golden angle apart, so that any number of
/// fragments stay distinct, at even lightness and moderate chroma.
[[nodiscard]] PieceColour pieceColour(int n);

/// Roll off highlights: the identity up to 0.7, then smoothly towards 1.
[[nodiscard]] glm::vec3 toneMap(glm::vec3 light);

/// The sRGB byte of a linear value; values outside 0..1 are clamped.
[[nodiscard]] std::uint8_t byteFromLinear(float value);

/// The linear value of an sRGB value 0..1.
[[nodiscard]] float linearFromSrgb(float value);

}  // namespace sherd
