// Where the picture is taken from.
#pragma once

#include <sherd/render.h>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "render/scene.h"

namespace sherd {

inline constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180.0;

/// A pinhole camera: the ray through pixel position (x, y) goes from `eye` along right * u + up * v
/// - back, with u and v from -tangent to tangent across the picture.
struct Camera {
  glm::vec3 eye{0.0f};
  glm::vec3 right{0.0f}, up{0.0f}, back{0.0f};
  float pixel = 1.0f;                         ///< width of a pixel at distance 1
  float halfWidth = 0.0f, halfHeight = 0.0f;  ///< pixels

  /// Towards a position in the picture, pixels from its upper left corner; not of unit length.
  [[nodiscard]] glm::vec3 direction(float x, float y) const {
    return right * ((x - halfWidth) * pixel) + up * ((halfHeight - y) * pixel) - back;
  }

  /// Where a point in front of the camera appears: the inverse of direction().
  [[nodiscard]] glm::vec2 project(glm::vec3 p) const {
    const glm::vec3 d = p - eye;
    const float scale = -1.0f / (glm::dot(d, back) * pixel);
    return {halfWidth + glm::dot(d, right) * scale, halfHeight - glm::dot(d, up) * scale};
  }
};

/// The closest camera of 35 degrees (across the picture's shorter side) that shows every vertex,
/// with a margin.
[[nodiscard]] Camera frameScene(const Scene& scene, const RenderOptions& options);

}  // namespace sherd
