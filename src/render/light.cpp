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

/// Returns the mean over 5x5 texels with half weight on the border, so that all cells of the
/// pattern weigh the same.
std::vector<glm::vec2> tent(const std::vector<glm::vec2>& map, int size) {
  std::vector<glm::vec2> result(map.size());
  tbb::parallel_for(0, size, [&](int y) {
    for (int x = 0; x < size; ++x) {
      glm::vec2 sum(0.0f);
      for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
          const float weight =
              (std::abs(dy) == 2 ? 0.5f : 1.0f) * (std::abs(dx) == 2 ? 0.5f : 1.0f);
          const int nx = std::clamp(x + dx, 0, size - 1), ny = std::clamp(y + dy, 0, size - 1);
          sum += weight * map[static_cast<std::size_t>(ny * size + nx)];
        }
      result[static_cast<std::size_t>(y * size + x)] = sum / static_cast<float>(kPatternCells);
    }
  });
  return result;
}

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

void ShadowPacket::set(std::size_t lane, glm::vec3 origin, glm::vec3 direction) {
  valid[lane] = -1;
  rays.org_x[lane] = origin.x, rays.org_y[lane] = origin.y, rays.org_z[lane] = origin.z;
  rays.dir_x[lane] = direction.x, rays.dir_y[lane] = direction.y, rays.dir_z[lane] = direction.z;
  rays.tnear[lane] = 0.0f, rays.tfar[lane] = std::numeric_limits<float>::infinity();
  rays.mask[lane] = ~0u, rays.flags[lane] = 0, rays.time[lane] = 0.0f;
}

std::array<float, 8> ShadowPacket::free(RTCScene scene, RTCIntersectContextFlags flags) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flags;
  rtcOccluded8(valid.data(), scene, &context, &rays);
  std::array<float, 8> result{};
  for (std::size_t i = 0; i < 8; ++i) result[i] = valid[i] && rays.tfar[i] > 0.0f ? 1.0f : 0.0f;
  return result;
}

GroundLight::GroundLight(const Scene& scene, const Light& light) : share_(kSize * kSize) {
  // The map covers the box's shadow and the occlusion of the sky at its base.
  constexpr float kMargin = 0.7f;
  glm::vec3 high(-std::numeric_limits<float>::infinity());
  low_ = -high;
  for (const glm::vec3& corner : scene.boxCorners) {
    const glm::vec3 cast =
        corner - light.keyDirection * ((corner.y - scene.groundY) / light.keyDirection.y);
    low_ = glm::min(low_, glm::min(corner, cast) - kMargin);
    high = glm::max(high, glm::max(corner, cast) + kMargin);
  }
  texel_ = std::max(high.x - low_.x, high.z - low_.z) / kSize;

  // As in the image, a texel traces its cell's share of the pattern and a tent filter combines all
  // cells.  Shadows reach further here, so there are more directions.
  constexpr std::uint32_t kPackets = 2, kGroundDirections = kPatternCells * 8 * kPackets;
  const std::vector<glm::vec3> keys = keyDirections(light, kGroundDirections);
  std::vector<glm::vec3> skies = skyDirections(kGroundDirections);
  for (glm::vec3& d : skies) d = {d.y, d.z, d.x};
  std::vector<glm::vec2> free(share_.size());
  tbb::parallel_for(0, kSize, [&](int z) {
    for (int x = 0; x < kSize; ++x) {
      const glm::vec3 origin(low_.x + (static_cast<float>(x) + 0.5f) * texel_,
                             scene.groundY - kLift,
                             low_.z + (static_cast<float>(z) + 0.5f) * texel_);
      const auto count = [&](const std::vector<glm::vec3>& directions,
                             RTCIntersectContextFlags flags) {
        float sum = 0.0f;
        for (std::uint32_t k = 0; k < kPackets; ++k) {
          ShadowPacket packet;
          for (std::uint32_t lane = 0; lane < 8; ++lane)
            packet.set(lane, origin,
                       directions[(k * 8 + lane) * kPatternCells +
                                  static_cast<std::uint32_t>(patternCell(x, z))]);
          for (const float f : packet.free(scene.embree.get(), flags)) sum += f;
        }
        return sum / (8.0f * kPackets);
      };
      free[static_cast<std::size_t>(z * kSize + x)] = {
          count(keys, RTC_INTERSECT_CONTEXT_FLAG_COHERENT),
          count(skies, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT)};
    }
  });

  // One pass combines the pattern; the second removes what remains visible of it in soft shadows.
  free = tent(tent(free, kSize), kSize);
  const glm::vec3 key = light.key * light.keyDirection.y;
  tbb::parallel_for(0, kSize, [&](int z) {
    for (int x = 0; x < kSize; ++x) {
      const std::size_t texel = static_cast<std::size_t>(z * kSize + x);
      const int edge = std::min(std::min(x, kSize - 1 - x), std::min(z, kSize - 1 - z));
      const float fade = glm::smoothstep(0.0f, 0.12f * kSize, static_cast<float>(edge));
      const glm::vec3 share = (key * free[texel].x + light.sky * free[texel].y) / (key + light.sky);
      share_[texel] = glm::mix(glm::vec3(1.0f), share, fade);
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
