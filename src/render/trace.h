// What the pixels of an image show, and which light reaches it.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "render/camera.h"
#include "render/light.h"
#include "render/occluders.h"
#include "render/raster.h"
#include "render/scene.h"

namespace sherd {

/// A surface of a fragment: 1 + 2 * fragment index + inner.
inline constexpr std::uint32_t kNoSurface = 0;

/// A smooth surface that some of a pixel's samples show.
struct Shown {
  std::uint32_t surface;
  std::uint32_t triangle;  ///< of the fragment, at one of the samples
  std::uint8_t samples;
  bool isLast;         ///< of the pixel's
  glm::vec3 position;  ///< scene space, at that sample
  glm::vec3 normal;    ///< smooth, towards the camera
};

/// The surfaces of a pixel.
struct PixelSurfaces {
  Shown* first;        ///< with kNoSurface if there is none
  std::size_t stride;  ///< from one to the next

  [[nodiscard]] Shown& operator[](std::size_t i) const { return first[i * stride]; }

  /// Calls visit for each.
  template <class Visit>
  void visit(const Visit& visit) const {
    if (first->surface == kNoSurface) return;
    for (const Shown* shown = first;; shown += stride) {
      visit(*shown);
      if (shown->isLast) return;
    }
  }
};

/// The light at a point of a square of 2x2 pixels.
struct LightPoint {
  std::uint32_t surface;
  glm::vec3 position;
  glm::vec3 normal;
  glm::vec2 free;      ///< shares of the key light and of the sky that are unoccluded
  glm::vec2 smoothed;  ///< mean over nearby points
};

inline constexpr float kSmooth = 0.9f;  ///< least cosine between normals of a smooth surface

/// Whether a point lies on the same smooth surface as another one.
///   reach  greatest distance from the tangent plane
[[nodiscard]] inline bool continues(const LightPoint& point, std::uint32_t surface,
                                    glm::vec3 position, glm::vec3 normal, float reach) {
  return point.surface == surface && glm::dot(point.normal, normal) > kSmooth &&
         std::abs(glm::dot(normal, point.position - position)) <= reach;
}

/// kTile rows of the image.
struct Band {
  static constexpr int kPointsPerSquare = 2;

  /// [4 * kTile * width] see `surfaces`.  Not zero-filled: the tracing threads touch their tiles'
  /// memory first, and many tiles, and most pixels' second surfaces, are never touched.
  std::unique_ptr<Shown[]> shown;
  /// [kTile / 2 * squares in a row * 2] up to 2 points, then one with kNoSurface.
  std::unique_ptr<LightPoint[]> points;
  std::vector<std::uint8_t> covered;  ///< [tiles in a row] 1 where the others are set

  explicit Band(int width);

  /// Returns those of the pixel at y * width + x in the band.
  [[nodiscard]] PixelSurfaces surfaces(int pixel) const {
    return {&shown[static_cast<std::size_t>(pixel)], pixels};
  }

 private:
  std::size_t pixels;
};

/// Inputs of tracing, the same for every tile.
struct Tracer {
  const Scene& scene;
  const Camera& camera;
  const Light& light;
  const Raster& raster;
  const Occluders& occluders;
  int width, height;                                ///< of the image, pixels
  static constexpr int kKeyRays = 4, kSkyRays = 8;  ///< at a point
  std::vector<glm::vec3> keys = keyDirections(light, kKeyRays* kPatternCells);
  std::vector<glm::vec3> skies = skyDirections(kSkyRays * kPatternCells);

  [[nodiscard]] int squares() const { return (width + 1) / 2; }  ///< in a row

  /// Fills one tile of a band: pixel (x, y) is at (y % kTile) * width + x, square (x / 2, y / 2) at
  /// (y % kTile) / 2 * squares() + x / 2.
  ///   tileX, tileY  pixel position divided by kTile
  void trace(int tileX, int tileY, Band& band) const;
};

}  // namespace sherd
