// Lighting: a soft key light, a sky, and light reflected from the ground.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "render/occluders.h"
#include "render/scene.h"

namespace sherd {

/// Ray directions repeat in a pattern: each cell of 4x4 has some of the directions, and a 5x5 tent
/// filter with half weight on the border covers every direction equally.
inline constexpr int kPatternSize = 4;
inline constexpr int kPatternCells = kPatternSize * kPatternSize;

/// Returns the cell 0..15 of the pattern, a Bayer matrix: 2x2 squares are spread out too.
[[nodiscard]] constexpr int patternCell(int x, int y) {
  constexpr std::array<int, kPatternCells> kBayer = {0, 8,  2, 10, 12, 4, 14, 6,
                                                     3, 11, 1, 9,  15, 7, 13, 5};
  return kBayer[static_cast<std::size_t>((y % kPatternSize) * kPatternSize + x % kPatternSize)];
}

/// The light sources, in scene space.
struct Light {
  glm::vec3 keyDirection{0.0f};  ///< to the middle of the key light, unit length
  glm::vec3 key{0.0f};           ///< irradiance of a surface that faces it
  glm::vec3 sky{0.0f};           ///< irradiance of a surface that faces straight up
  glm::vec3 ground{0.0f};        ///< irradiance of a surface that faces straight down
};

/// Returns the light for a camera azimuth in radians; the key light is above its left shoulder.
[[nodiscard]] Light makeLight(float azimuth);

/// Returns n directions to points of the key light's disk, [n].
[[nodiscard]] std::vector<glm::vec3> keyDirections(const Light& light, std::uint32_t n);

/// Returns n cosine-weighted directions of the hemisphere about +z, [n].
[[nodiscard]] std::vector<glm::vec3> skyDirections(std::uint32_t n);

/// An axis frame whose third axis is the unit vector n: n = x * right + y * up + z * n.
/// source  T. Duff et al., Building an Orthonormal Basis, Revisited, 2017
struct Frame {
  glm::vec3 x{0.0f}, y{0.0f}, z{0.0f};
};
[[nodiscard]] Frame frameAround(glm::vec3 n);

/// Square map of the light on the ground, relative to open ground.
class GroundLight {
 public:
  GroundLight(const Scene& scene, const Light& light, const Occluders& occluders);

  /// Returns the light at a point, 0..1 of open ground's, per color channel.
  [[nodiscard]] glm::vec3 at(float x, float z) const;

 private:
  static constexpr int kSize = 240;
  glm::vec3 low_{0.0f};
  float texel_ = 1.0f;
  std::vector<glm::vec3> share_;  // [kSize * kSize] of texel centers, rows along x
};

}  // namespace sherd
