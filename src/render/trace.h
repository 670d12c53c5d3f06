// Traces the samples of an image, and which light reaches them.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "render/camera.h"
#include "render/light.h"
#include "render/scene.h"

namespace sherd {

/// Pixels along a tile's side: whole pattern squares, and whole packets of eight squares.
inline constexpr int kTile = 32;

/// The hit of a sample on a fragment.
struct Sample {
  glm::vec3 position;  ///< scene space
  glm::vec3 normal;    ///< smooth, towards the camera
  float key;           ///< 1 where its ray to the key light is unoccluded
  float sky;           ///< 1 where its ray to the sky is unoccluded
};

/// kTile rows of the image.
struct Band {
  static constexpr std::uint32_t kNothing = 0;

  /// [4 * kTile * width] kNothing, or 1 + 2 * fragment index + inner
  std::unique_ptr<std::uint32_t[]> surface;
  /// [4 * kTile * width] set where surface is.  Not zero-filled: the tracing threads touch their
  /// tiles' memory first, and many tiles are never touched.
  std::unique_ptr<Sample[]> samples;

  explicit Band(int width) {
    const auto size = static_cast<std::size_t>(kSamplesPerPixel * kTile * width);
    surface = std::make_unique_for_overwrite<std::uint32_t[]>(size);
    samples = std::make_unique_for_overwrite<Sample[]>(size);
  }
};

/// The blocks of 16x8 pixels, the footprint of a packet, that may show a fragment: those that the
/// image-space box of a triangle touches.
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

/// Inputs of tracing, the same for every tile.
struct Tracer {
  const Scene& scene;
  const Camera& camera;
  const Light& light;
  const Coverage& coverage;
  int width;  ///< of the image, pixels
  std::vector<glm::vec3> keys = keyDirections(light, kDirections);
  std::vector<glm::vec3> skies = skyDirections(kDirections);

  /// Fills one tile of a band; a sample's index there is (sample * kTile + row) * width + x.
  ///   x0, y0  the tile's upper left pixel; rows count from y0
  void trace(int x0, int y0, Band& band) const;
};

}  // namespace sherd
