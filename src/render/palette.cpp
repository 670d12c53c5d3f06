// The colors of fragments, tone mapping and sRGB encoding.
#include "render/palette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>

namespace sherd {
namespace {

constexpr float kGoldenAngle = 2.39996323f;  // radians

/// source  B. Ottosson, A perceptual color space for image processing, 2020
glm::vec3 linearFromOklch(float lightness, float chroma, float hue) {
  const float a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const float l = lightness + 0.3963377774f * a + 0.2158037573f * b;
  const float m = lightness - 0.1055613458f * a - 0.0638541728f * b;
  const float s = lightness - 0.0894841775f * a - 1.2914855480f * b;
  const float l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
  return {4.0767416621f * l3 - 3.3077115913f * m3 + 0.2309699292f * s3,
          -1.2684380046f * l3 + 2.6097574011f * m3 - 0.3413193965f * s3,
          -0.0041960863f * l3 - 0.7034186147f * m3 + 1.7076147010f * s3};
}

/// Returns the color, with its chroma reduced until sRGB can represent it.
glm::vec3 inGamut(float lightness, float chroma, float hue) {
  for (;; chroma *= 0.95f) {
    const glm::vec3 c = linearFromOklch(lightness, chroma, hue);
    const bool shown = std::min({c.x, c.y, c.z}) >= 0.0f && std::max({c.x, c.y, c.z}) <= 1.0f;
    if (shown || chroma < 1e-3f) return glm::clamp(c, 0.0f, 1.0f);
  }
}

double encoded(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

}  // namespace

FragmentColor fragmentColor(int n) {
  // Hues a golden angle apart nearly repeat after 5, 8 and 13 steps; three levels of lightness
  // separate those.
  constexpr std::array<float, 3> kLightness = {0.69f, 0.75f, 0.63f};
  const float hue = std::fmod(0.70f + kGoldenAngle * static_cast<float>(n), 6.28318531f);
  const float lightness = kLightness[static_cast<std::size_t>(n % 3)];
  return {inGamut(lightness, 0.098f, hue), inGamut(lightness + 0.14f, 0.050f, hue)};
}

glm::vec3 toneMap(glm::vec3 light) {
  constexpr float kKnee = 0.7f;
  for (int i = 0; i < 3; ++i) {
    const float over = (light[i] - kKnee) / (1.0f - kKnee);
    if (over > 0.0f) light[i] = kKnee + (1.0f - kKnee) * over / (1.0f + over);
  }
  return light;
}

std::uint8_t byteFromLinear(float value) {
  constexpr int kSteps = 1 << 14;  // the curve's steepest byte is five steps wide
  static const std::array<std::uint8_t, kSteps + 1> kBytes = [] {
    std::array<std::uint8_t, kSteps + 1> bytes{};
    for (int i = 0; i <= kSteps; ++i) {
      const double x = static_cast<double>(i) / kSteps;
      bytes[static_cast<std::size_t>(i)] =
          static_cast<std::uint8_t>(std::lround(255.0 * encoded(x)));
    }
    return bytes;
  }();
  const float clamped = std::clamp(value, 0.0f, 1.0f);
  return kBytes[static_cast<std::size_t>(clamped * kSteps + 0.5f)];
}

float srgbFromLinear(float value) {
  constexpr int kSteps = 1 << 12;  // interpolated linearly
  static const std::array<float, kSteps + 2> kValues = [] {
    std::array<float, kSteps + 2> values{};
    for (int i = 0; i < kSteps + 2; ++i)
      values[static_cast<std::size_t>(i)] =
          static_cast<float>(encoded(static_cast<double>(i) / kSteps));
    return values;
  }();
  const float at = kSteps * std::clamp(value, 0.0f, 1.0f);
  const auto i = static_cast<std::size_t>(at);
  return kValues[i] + (at - static_cast<float>(i)) * (kValues[i + 1] - kValues[i]);
}

float linearFromSrgb(float value) {
  return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

}  // namespace sherd
