// Where the picture is taken from.
#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace sherd {
namespace {

constexpr float kFieldOfView = 0.61086524f;  // 35 degrees
constexpr float kMargin = 0.07f;  // share of the picture left free on each side, at least

/// The least distance along `back`, and the place aside, from which all points lie within the wedge
/// of two planes: |a - place| <= tangent * (distance - z) for every point (a, z).
struct Wedge {
  float tangent;
  float high = -std::numeric_limits<float>::infinity();
  float low = -std::numeric_limits<float>::infinity();

  void add(float a, float z) {
    high = std::max(high, a + tangent * z);
    low = std::max(low, -a + tangent * z);
  }
  float distance() const { return (high + low) / (2.0f * tangent); }
  float place() const { return 0.5f * (high - low); }
};

}  // namespace

Camera frameScene(const Scene& scene, const RenderOptions& options) {
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
  for (const Piece& piece : scene.pieces)
    for (std::size_t v = 0; v + 1 < piece.vertices.size(); ++v, empty = false)
      add(piece.vertices[v]);
  if (empty)
    for (const glm::vec3& corner : scene.boxCorners) add(corner);
  // A speck or a needle seen from its end would otherwise touch the lens.
  const float distance = std::max({across.distance(), along.distance(), nearest + 0.05f});
  camera.eye = camera.right * across.place() + camera.up * along.place() + camera.back * distance;
  return camera;
}

}  // namespace sherd
