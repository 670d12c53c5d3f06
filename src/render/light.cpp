// Lighting: a soft key light, a sky, and light reflected from the ground.
#include "render/light.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace sherd {
namespace {

constexpr float kPi = 3.14159265f;
constexpr float kKeyRadius = 0.16f;     // tangent of the key light's half angle: 9 degrees
constexpr float kKeyElevation = 0.93f;  // radians above the horizon
constexpr float kKeyAside = 0.80f;      // radians to the left of the camera
constexpr float kBelow = 2e-4f;         // of the ground under the fragments, scene units

/// Maps the unit square to the unit disk, preserving area ratios and neighborhoods.
/// source  P. Shirley and K. Chiu, A Low Distortion Map Between Disk and Square, 1997
glm::vec2 onDisk(glm::vec2 square) {
  const float a = 2.0f * square.x - 1.0f, b = 2.0f * square.y - 1.0f;
  if (a == 0.0f && b == 0.0f) return {0.0f, 0.0f};
  const bool wide = std::abs(a) > std::abs(b);
  const float r = wide ? a : b;
  const float phi = wide ? kPi / 4.0f * (b / a) : kPi / 2.0f - kPi / 4.0f * (a / b);
  return {r * std::cos(phi), r * std::sin(phi)};
}

float reverseBits(std::uint32_t i) {
  float value = 0.0f, bit = 0.5f;
  for (; i != 0; i >>= 1, bit *= 0.5f)
    if (i & 1) value += bit;
  return value;
}

/// Returns point i of n from Sobol's first two dimensions, centered in its cell of the unit square.
/// Each run of 2^k consecutive points is stratified.
glm::vec2 sobol(std::uint32_t i, std::uint32_t n) {
  std::uint32_t second = 0, direction = 1u << 31;
  for (std::uint32_t rest = i; rest != 0; rest >>= 1, direction ^= direction >> 1)
    if (rest & 1) second ^= direction;
  const float half = 0.5f / static_cast<float>(n);
  return {reverseBits(i) + half, static_cast<float>(second >> 8) * 0x1p-24f + half};
}

/// A square map of values, rows along x.
struct Map {
  int size;
  std::vector<float> values = std::vector<float>(static_cast<std::size_t>(size * size));

  float& at(int x, int z) { return values[static_cast<std::size_t>(z * size + x)]; }
  float at(int x, int z) const { return values[static_cast<std::size_t>(z * size + x)]; }
};

/// Returns the mean over five texels of each row, with half weight on the ends, and swaps x and z.
Map tentAlongX(const Map& map) {
  Map result{map.size};
  const int last = map.size - 1;
  tbb::parallel_for(0, map.size, [&](int z) {
    for (int x = 0; x < map.size; ++x)
      result.at(z, x) =
          0.25f *
          (0.5f * map.at(std::max(x - 2, 0), z) + map.at(std::max(x - 1, 0), z) + map.at(x, z) +
           map.at(std::min(x + 1, last), z) + 0.5f * map.at(std::min(x + 2, last), z));
  });
  return result;
}

/// Returns the mean over 5x5 texels with half weight on the border, so that all cells of the
/// pattern weigh the same.
Map tent(const Map& map) { return tentAlongX(tentAlongX(map)); }

/// The light that reaches a square of the ground.
struct Ground {
  const Occluders& occluders;
  glm::vec3 low;  ///< corner of the square
  float side;
  glm::vec3 shadowLow, shadowHigh;                  ///< box of the key light's shadow
  static constexpr int kKeyRays = 4, kSkyRays = 2;  ///< at a texel

  /// Whether a texel may lie in the shadow that the box of the fragments throws.
  bool isShaded(int size, int x, int z) const {
    const float texel = side / static_cast<float>(size);
    const float atX = low.x + (static_cast<float>(x) + 0.5f) * texel;
    const float atZ = low.z + (static_cast<float>(z) + 0.5f) * texel;
    return atX >= shadowLow.x && atX <= shadowHigh.x && atZ >= shadowLow.z && atZ <= shadowHigh.z;
  }

  /// As in the image, a texel traces its cell's share of the pattern.
  float traced(const std::vector<glm::vec3>& directions, int size, int x, int z) const {
    const float texel = side / static_cast<float>(size);
    const glm::vec3 origin(low.x + (static_cast<float>(x) + 0.5f) * texel, low.y,
                           low.z + (static_cast<float>(z) + 0.5f) * texel);
    float sum = 0.0f;
    for (auto i = static_cast<std::size_t>(patternCell(x, z)); i < directions.size();
         i += kPatternCells)
      sum += occluders.free(origin, directions[i], 0.0f);
    return sum * kPatternCells / static_cast<float>(directions.size());
  }

  Map skyMap(int size) const {
    std::vector<glm::vec3> directions = skyDirections(kSkyRays * kPatternCells);
    for (glm::vec3& d : directions) d = {d.y, d.z, d.x};
    Map map{size};
    tbb::parallel_for(0, size, [&](int z) {
      for (int x = 0; x < size; ++x) map.at(x, z) = traced(directions, size, x, z);
    });
    return map;
  }

  /// Traces every second texel of every second row, and those where the ones beside them differ:
  /// outside of the shadow's soft edge they agree.
  Map keyMap(const Light& light, int size) const {
    const std::vector<glm::vec3> directions = keyDirections(light, kKeyRays * kPatternCells);
    Map map{size};
    tbb::parallel_for(0, size / 2, [&](int z) {
      for (int x = 0; x < size; x += 2)
        map.at(x, 2 * z) = isShaded(size, x, 2 * z) ? traced(directions, size, x, 2 * z) : 1.0f;
    });
    tbb::parallel_for(0, size, [&](int z) {
      for (int x = z % 2 == 0 ? 1 : 0; x < size; x += z % 2 == 0 ? 2 : 1) {
        const int left = x - x % 2, right = std::min(left + 2 * (x % 2), size - 2);
        const int top = z - z % 2, bottom = std::min(top + 2 * (z % 2), size - 2);
        const float value = map.at(left, top);
        const bool agrees = (value == 0.0f || value == 1.0f) && map.at(right, top) == value &&
                            map.at(left, bottom) == value && map.at(right, bottom) == value;
        map.at(x, z) = agrees ? value : traced(directions, size, x, z);
      }
    });
    return map;
  }
};

}  // namespace

Light makeLight(float azimuth) {
  Light light;
  const float side = azimuth - kKeyAside;
  light.keyDirection = {std::sin(side) * std::cos(kKeyElevation), std::sin(kKeyElevation),
                        std::cos(side) * std::cos(kKeyElevation)};
  light.key = glm::vec3(1.00f, 0.965f, 0.91f) * 0.92f;
  light.sky = glm::vec3(0.93f, 0.97f, 1.00f) * 0.58f;
  light.ground = glm::vec3(1.00f, 0.97f, 0.93f) * 0.42f;
  return light;
}

std::vector<glm::vec3> keyDirections(const Light& light, std::uint32_t n) {
  const Frame frame = frameAround(light.keyDirection);
  std::vector<glm::vec3> directions;
  for (std::uint32_t i = 0; i < n; ++i) {
    const glm::vec2 disk = kKeyRadius * onDisk(sobol(i, n));
    directions.push_back(glm::normalize(frame.z + disk.x * frame.x + disk.y * frame.y));
  }
  return directions;
}

std::vector<glm::vec3> skyDirections(std::uint32_t n) {
  std::vector<glm::vec3> directions;
  for (std::uint32_t i = 0; i < n; ++i) {
    // The key light's pattern in reverse, which decorrelates the errors of key and sky.
    const glm::vec2 disk = onDisk(sobol(n - 1 - i, n));
    directions.emplace_back(disk, std::sqrt(std::max(0.0f, 1.0f - glm::dot(disk, disk))));
  }
  return directions;
}

Frame frameAround(glm::vec3 n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
  return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

GroundLight::GroundLight(const Scene& scene, const Light& light, const Occluders& occluders)
    : share_(kSize * kSize) {
  // The map covers the box's shadow and the occlusion of the sky at its base.
  constexpr float kMargin = 0.7f;
  glm::vec3 high(-std::numeric_limits<float>::infinity());
  low_ = -high;
  for (const glm::vec3& corner : scene.boxCorners) {
    const glm::vec3 cast =
        corner - light.keyDirection * ((corner.y - scene.groundY) / light.keyDirection.y);
    low_ = glm::min(low_, glm::min(corner, cast));
    high = glm::max(high, glm::max(corner, cast));
  }
  // The light's disk shifts a point's shadow by at most its height times twice the disk's radius.
  const float soft = 2.0f * kKeyRadius * (high.y - scene.groundY) / light.keyDirection.y;
  const glm::vec3 shadowLow = low_ - soft, shadowHigh = high + soft;
  low_ -= kMargin, high += kMargin;
  texel_ = std::max(high.x - low_.x, high.z - low_.z) / kSize;
  const Ground ground{occluders,
                      {low_.x, scene.groundY - kBelow, low_.z},
                      texel_ * static_cast<float>(kSize),
                      shadowLow,
                      shadowHigh};
  // One pass combines the pattern; the second removes what remains visible of it in soft shadows.
  const Map keyFree = tent(tent(tent(ground.keyMap(light, kSize))));
  const Map skyFree = tent(tent(ground.skyMap(kSize / 2)));
  const glm::vec3 key = light.key * light.keyDirection.y;
  tbb::parallel_for(0, kSize, [&](int z) {
    // The sky's texels are twice as large: a quarter of one to the left or right, and up or down.
    const auto near = [](int i) { return i / 2; };
    const auto far = [](int i) {
      return std::clamp(i / 2 + (i % 2 == 0 ? -1 : 1), 0, kSize / 2 - 1);
    };
    for (int x = 0; x < kSize; ++x) {
      const float sky = (9.0f * skyFree.at(near(x), near(z)) + 3.0f * skyFree.at(far(x), near(z)) +
                         3.0f * skyFree.at(near(x), far(z)) + skyFree.at(far(x), far(z))) /
                        16.0f;
      const int edge = std::min(std::min(x, kSize - 1 - x), std::min(z, kSize - 1 - z));
      const float fade = glm::smoothstep(0.0f, 0.12f * kSize, static_cast<float>(edge));
      const glm::vec3 share = (key * keyFree.at(x, z) + light.sky * sky) / (key + light.sky);
      share_[static_cast<std::size_t>(z * kSize + x)] = glm::mix(glm::vec3(1.0f), share, fade);
    }
  });
}

glm::vec3 GroundLight::at(float x, float z) const {
  const float u = (x - low_.x) / texel_ - 0.5f, v = (z - low_.z) / texel_ - 0.5f;
  if (!(u > 0.0f && v > 0.0f && u < kSize - 1 && v < kSize - 1)) return glm::vec3(1.0f);
  const int i = std::min(static_cast<int>(u), kSize - 2),
            j = std::min(static_cast<int>(v), kSize - 2);
  const float fu = u - static_cast<float>(i), fv = v - static_cast<float>(j);
  const glm::vec3* corner = &share_[static_cast<std::size_t>(j * kSize + i)];
  return glm::mix(glm::mix(corner[0], corner[1], fu),
                  glm::mix(corner[kSize], corner[kSize + 1], fu), fv);
}

}  // namespace sherd
