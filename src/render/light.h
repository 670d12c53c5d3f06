// The light of the picture: a soft key light, a sky, and what the ground gives back.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "render/scene.h"

namespace sherd {

/// Rays leave a surface from this far above it, in scene space, where floats are good to 1e-7.
inline constexpr float kLift = 2e-4f;

/// Rays go out in a repeating pattern: the pixels of every 4x4 square, four samples each, take one
/// direction each out of 64.  Neighbours then share directions four pixels apart, which makes
/// coherent packets, and a 5x5 tent whose border counts half sees every direction equally often.
inline constexpr int kPatternSize = 4;
inline constexpr int kPatternCells = kPatternSize * kPatternSize;
inline constexpr int kSamplesPerPixel = 4;
inline constexpr std::uint32_t kDirections = kPatternCells * kSamplesPerPixel;

/// Place 0..15 in the pattern, so that every 2x2 square of pixels is spread out too (a Bayer
/// matrix).
[[nodiscard]] constexpr int patternCell(int x, int y) {
  constexpr std::array<int, kPatternCells> kBayer = {0, 8,  2, 10, 12, 4, 14, 6,
                                                     3, 11, 1, 9,  15, 7, 13, 5};
  return kBayer[static_cast<std::size_t>((y % kPatternSize) * kPatternSize + x % kPatternSize)];
}

/// What light is there, in scene space.
struct Light {
  glm::vec3 keyDirection{0.0f};  ///< to the middle of the key light, unit length
  glm::vec3 key{0.0f};           ///< irradiance of a surface that faces it
  glm::vec3 sky{0.0f};           ///< irradiance of a surface that looks straight up
  glm::vec3 ground{0.0f};        ///< irradiance of a surface that looks straight down
};

/// The light for a camera at this azimuth (radians): the key comes from over its left shoulder.
[[nodiscard]] Light makeLight(float azimuth);

/// The first n directions to points of the key light's disk.
[[nodiscard]] std::vector<glm::vec3> keyDirections(const Light& light, std::uint32_t n);

/// n directions about +z, denser where they count more (cosine-weighted).
[[nodiscard]] std::vector<glm::vec3> skyDirections(std::uint32_t n);

/// An axis frame whose third axis is the unit vector n: n = x * right + y * up + z * n.
/// source  T. Duff et al., Building an Orthonormal Basis, Revisited, 2017
struct Frame {
  glm::vec3 x{0.0f}, y{0.0f}, z{0.0f};
};
[[nodiscard]] Frame frameAround(glm::vec3 n);

/// Eight rays that only ask whether something is in the way.
struct ShadowPacket {
  alignas(32) std::array<int, 8> valid{};
  RTCRay8 rays;

  void set(std::size_t lane, glm::vec3 origin, glm::vec3 direction);
  /// 1 for a lane that is valid and free.
  [[nodiscard]] std::array<float, 8> free(RTCScene scene, RTCIntersectContextFlags flags);
};

/// How much light falls on the ground: 1 where nothing is near, laid out as a square map.
class GroundLight {
 public:
  GroundLight(const Scene& scene, const Light& light);

  /// Share of the open ground's light, per colour.
  [[nodiscard]] glm::vec3 at(float x, float z) const;

 private:
  static constexpr int kSize = 240;
  glm::vec3 low_{0.0f};
  float texel_ = 1.0f;
  std::vector<glm::vec3> share_;  // [kSize * kSize] of texel centres, rows along x
};

}  // namespace sherd
