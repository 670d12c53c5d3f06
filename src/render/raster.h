// Which triangle each sample of an image shows.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "render/camera.h"
#include "render/scene.h"

namespace sherd {

/// Pixels along a tile's side: whole squares of the light's pattern.
inline constexpr int kTile = 32;

inline constexpr int kSamplesPerPixel = 4;

/// Sample positions in a pixel: a rotated grid, one per row and column.
inline constexpr std::array<glm::vec2, kSamplesPerPixel> kInPixel = {
    {{0.375f, 0.125f}, {0.875f, 0.375f}, {0.125f, 0.625f}, {0.625f, 0.875f}}};

/// What a tile's samples show.
struct TileHits {
  static constexpr std::uint32_t kNothing = 0;

  struct Triangle {
    std::uint32_t fragment, triangle;
  };
  /// That may be visible: the first one is unused, then those that face the camera, then others.
  std::vector<Triangle> triangles;
  std::size_t fronts = 0;  ///< the end of those that face the camera
  /// [(y * kTile + x) * 4 + sample] kNothing, or an index of `triangles`
  std::array<std::uint32_t, kSamplesPerPixel * kTile * kTile> shown;
};

/// The triangles of a scene, projected and sorted by the tiles that they may cover.
class Raster {
 public:
  Raster(const Scene& scene, const Camera& camera);

  /// Draws one tile; false if no triangle's box meets it, and then `hits` is as before.
  ///   tileX, tileY  pixel position divided by kTile
  bool draw(int tileX, int tileY, TileHits& hits) const;

  /// Returns the barycentric coordinates (of corners y and z) of the surface at an image position.
  [[nodiscard]] glm::vec2 barycentric(const TileHits::Triangle& triangle, glm::vec2 position) const;

 private:
  struct Tiles {                       // of one fragment
    glm::ivec2 low{0}, size{0};        // rectangle of tiles
    std::vector<std::uint32_t> first;  // [2 * size.x * size.y + 1] for each tile front, then back
    std::vector<std::uint32_t> triangles;
  };
  void sortTriangles(std::size_t fragment);

  const Scene& scene_;
  float rounding_;  // pixels; far above the error of edges in floats
  glm::ivec2 tiles_;
  std::vector<std::vector<glm::vec3>> screen_;  // [fragments][vertices] pixels, and 1 / depth
  std::vector<Tiles> sorted_;                   // [fragments]
};

}  // namespace sherd
