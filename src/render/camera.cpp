// The camera that frames a scene.
#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace sherd {
namespace {

constexpr float kFieldOfView = 0.61086524f;  // 35 degrees
constexpr float kMargin = 0.07f;             // least empty share of the image on each side

/// The least distance along `back`, and the lateral offset, from which all points lie within the
/// wedge of two planes: |a - offset| <= tangent * (distance - z) for every point (a, z).
struct Wedge {
  float tangent;
  float high = -std::numeric_limits<float>::infinity();
  float low = -std::numeric_limits<float>::infinity();

  void add(float a, float z) {
    high = std::max(high, a + tangent * z);
    low = std::max(low, -a + tangent * z);
  }
  float distance() const { return (high + low) / (2.0f * tangent); }
  float offset() const { return 0.5f * (high - low); }
};

// A box in an image, pixels; empty where low is above high.
struct ImageBox {
  glm::vec2 low{std::numeric_limits<float>::infinity()};
  glm::vec2 high{-std::numeric_limits<float>::infinity()};
};

ImageBox boxInImage(const Camera& camera, const Scene& scene, std::span<const int> ids,
                    std::span<const int> shown) {
  ImageBox box;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (std::find(shown.begin(), shown.end(), ids[i]) == shown.end()) continue;
    const std::vector<glm::vec3>& vertices = scene.fragments[i].vertices;
    for (std::size_t v = 0; v + 1 < vertices.size(); ++v) {
      const glm::vec2 at(camera.project(vertices[v]));
      box.low = glm::min(box.low, at);
      box.high = glm::max(box.high, at);
    }
  }
  return box;
}

// Moves a box of the image to its middle and makes it as large as the margins allow, then larger
// or smaller about the middle.
void magnify(Camera& camera, const ImageBox& box, double zoom) {
  constexpr float kLeast = 1e-3f;  // side of a box, pixels: of one vertex it is 0
  const glm::vec2 half(camera.halfWidth, camera.halfHeight);
  glm::vec2 middle = half;
  auto scale = static_cast<float>(zoom);
  if (box.low.x <= box.high.x) {
    middle = 0.5f * (box.low + box.high);
    const glm::vec2 sides = glm::max(box.high - box.low, glm::vec2(kLeast));
    scale *= (1.0f - 2.0f * kMargin) * 2.0f * std::min(half.x / sides.x, half.y / sides.y);
  }
  camera.pixel /= scale;
  camera.center = half - scale * (middle - half);
}

}  // namespace

Camera frameScene(const Scene& scene, std::span<const int> ids, const RenderOptions& options) {
  const double a = std::fmod(options.azimuth, 360.0) * kRadiansPerDegree;
  const double e = options.elevation * kRadiansPerDegree;
  Camera camera;
  camera.back = glm::dvec3(std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e));
  camera.right = glm::dvec3(std::cos(a), 0.0, -std::sin(a));
  camera.up = glm::cross(camera.back, camera.right);
  camera.halfWidth = 0.5f * static_cast<float>(options.width);
  camera.halfHeight = 0.5f * static_cast<float>(options.height);
  camera.pixel = std::tan(0.5f * kFieldOfView) / std::min(camera.halfWidth, camera.halfHeight);

  Wedge across{(1.0f - 2.0f * kMargin) * camera.pixel * camera.halfWidth};
  Wedge along{(1.0f - 2.0f * kMargin) * camera.pixel * camera.halfHeight};
  float nearest = -std::numeric_limits<float>::infinity();
  const auto add = [&](const glm::vec3& p) {
    const float z = glm::dot(p, camera.back);
    nearest = std::max(nearest, z);
    across.add(glm::dot(p, camera.right), z);
    along.add(glm::dot(p, camera.up), z);
  };
  bool empty = true;
  for (const SceneFragment& fragment : scene.fragments)
    for (std::size_t v = 0; v + 1 < fragment.vertices.size(); ++v, empty = false)
      add(fragment.vertices[v]);
  if (empty)
    for (const glm::vec3& corner : scene.boxCorners) add(corner);
  // Without the minimum a tiny fragment, or a needle seen from its end, touches the lens.
  const float distance = std::max({across.distance(), along.distance(), nearest + 0.05f});
  camera.eye = camera.right * across.offset() + camera.up * along.offset() + camera.back * distance;
  camera.center = {camera.halfWidth, camera.halfHeight};
  magnify(camera, boxInImage(camera, scene, ids, options.focus), options.zoom);
  return camera;
}

}  // namespace sherd
