// The camera that frames a scene.
#pragma once

#include <sherd/render.h>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "render/scene.h"

namespace sherd {

inline constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180.0;

/// A pinhole camera: the ray through pixel position (x, y) goes from `eye` along right * u + up * v
/// - back, with u and v from -tangent to tangent across the image.
struct Camera {
  glm::vec3 eye{0.0f};
  glm::vec3 right{0.0f}, up{0.0f}, back{0.0f};
  float pixel = 1.0f;                         ///< width of a pixel at distance 1
  float halfWidth = 0.0f, halfHeight = 0.0f;  ///< pixels
  glm::vec2 center{0.0f};  ///< image position of the axis, pixels; may be outside

  /// Returns the direction to an image position, pixels from the upper left corner; not normalized.
  [[nodiscard]] glm::vec3 direction(float x, float y) const {
    return right * ((x - center.x) * pixel) + up * ((center.y - y) * pixel) - back;
  }

  /// Returns the image position of a point in front of the camera, the inverse of direction(), and
  /// one over its distance along `back`.
  [[nodiscard]] glm::vec3 project(glm::vec3 p) const {
    const glm::vec3 d = p - eye;
    const float near = -1.0f / glm::dot(d, back), scale = near / pixel;
    return {center.x + glm::dot(d, right) * scale, center.y - glm::dot(d, up) * scale, near};
  }

  /// Returns the distance from a surface's tangent plane within which it goes on a few pixels away.
  [[nodiscard]] float reachAt(glm::vec3 p) const { return 3.0f * pixel * glm::dot(eye - p, back); }
};

/// Returns the closest camera that shows every vertex with a margin; its field of view is 35
/// degrees across the image's shorter side.  RenderOptions::focus and zoom choose a part of its
/// image, larger: the camera does not move, so nothing comes before or behind it.
///   ids  [scene.fragments]
[[nodiscard]] Camera frameScene(const Scene& scene, std::span<const int> ids,
                                const RenderOptions& options);

}  // namespace sherd
