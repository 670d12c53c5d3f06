// What each sample of the picture sees, and which light reaches it.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "render/camera.h"
#include "render/light.h"
#include "render/scene.h"

namespace sherd {

/// A tile is traced at a time: whole pattern squares, and whole packets of eight squares.
inline constexpr int kTile = 32;

/// What a sample sees when it sees a fragment.
struct Sample {
  glm::vec3 position;  ///< scene space
  glm::vec3 normal;    ///< smooth, towards the camera
  float key;           ///< 1 where its one ray to the key light is free
  float sky;           ///< 1 where its one ray to the sky is free
};

/// kTile rows of the picture.
struct Band {
  static constexpr std::uint32_t kNothing = 0;

  /// [4 * kTile * width] kNothing, or 1 + 2 * piece + inner
  std::unique_ptr<std::uint32_t[]> surface;
  /// [4 * kTile * width] set where surface is.  Not filled with zeros before: the threads that
  /// trace touch their tiles first, and many tiles nobody touches.
  std::unique_ptr<Sample[]> samples;

  explicit Band(int width) {
    const auto size = static_cast<std::size_t>(kSamplesPerPixel * kTile * width);
    surface = std::make_unique_for_overwrite<std::uint32_t[]>(size);
    samples = std::make_unique_for_overwrite<Sample[]>(size);
  }
};

/// Which blocks of 16x8 pixels, the footprint of a packet, may show a fragment: those that a
/// triangle's box in the picture touches.
class Coverage {
 public:
  static constexpr int kWidth = 16, kHeight = 8;  ///< pixels

  Coverage(const Scene& scene, const Camera& camera);

  [[nodiscard]] bool at(int x, int y) const {
    return covered_[static_cast<std::size_t>(y / kHeight * columns_ + x / kWidth)] != 0;
  }

 private:
  int columns_, rows_;
  std::vector<std::uint8_t> covered_;
};

/// What tracing needs, the same for every tile.
struct Tracer {
  const Scene& scene;
  const Camera& camera;
  const Light& light;
  const Coverage& coverage;
  int width;  ///< of the picture, pixels
  std::vector<glm::vec3> keys = keyDirections(light, kDirections);
  std::vector<glm::vec3> skies = skyDirections(kDirections);

  /// Fill one tile of a band.  A sample's place there is (sample * kTile + row) * width + x.
  ///   x0, y0  the tile's upper left pixel; rows count from y0
  void trace(int x0, int y0, Band& band) const;
};

}  // namespace sherd
