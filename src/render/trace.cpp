// What the pixels of an image show, and which light reaches it.
#include "render/trace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

namespace sherd {
namespace {

/// Rotates a direction about +z to the smooth normal, and reflects it above the face.
glm::vec3 skyDirection(glm::vec3 d, glm::vec3 normal, glm::vec3 face) {
  const Frame frame = frameAround(normal);
  const glm::vec3 rotated = d.x * frame.x + d.y * frame.y + d.z * frame.z;
  const float below = std::min(0.0f, glm::dot(rotated, face));
  return rotated - 2.0f * below * face;
}

struct Tile {
  const Tracer& tracer;
  int x0, y0;  ///< upper left pixel
  const TileHits& hits;
  Band& band;
  int squares;  ///< in a row

  const SceneFragment& fragmentOf(const Shown& shown) const {
    return tracer.scene.fragments[(shown.surface - 1) / 2];
  }
  PixelSurfaces pixel(int x, int y) const { return band.surfaces(y * tracer.width + x0 + x); }

  Shown shownBy(std::uint32_t hit, glm::vec2 position) const;
  bool isPartOf(const Shown& shown, std::uint32_t hit) const;
  void findShown(int x, int y) const;

  std::size_t pointsOf(int squareX, int squareY) const;
  std::optional<float> agreedKey(const LightPoint& point, int squareX, int squareY) const;
  void light(LightPoint& point, std::optional<float> key, glm::vec3 face, int cell) const;
  void lightSquare(int squareX, int squareY) const;
  void lightSquares() const;
};

Shown Tile::shownBy(std::uint32_t hit, glm::vec2 position) const {
  const TileHits::Triangle& triangle = hits.triangles[hit];
  const SceneFragment& fragment = tracer.scene.fragments[triangle.fragment];
  const glm::uvec3& t = fragment.triangles[triangle.triangle];
  const glm::vec2 at = tracer.raster.barycentric(triangle, position);
  const glm::vec3 normal = fragment.normalAt(triangle.triangle, at.x, at.y);
  return {1 + 2 * triangle.fragment + fragment.inner[triangle.triangle],
          triangle.triangle,
          kSamplesPerPixel,
          true,
          (1.0f - at.x - at.y) * fragment.vertices[t.x] + at.x * fragment.vertices[t.y] +
              at.y * fragment.vertices[t.z],
          hit < hits.fronts ? normal : -normal};
}

/// Whether a triangle continues a surface: nearly its normal at one corner.
bool Tile::isPartOf(const Shown& shown, std::uint32_t hit) const {
  const TileHits::Triangle& triangle = hits.triangles[hit];
  const SceneFragment& fragment = tracer.scene.fragments[triangle.fragment];
  const float cosine =
      glm::dot(shown.normal, fragment.normals[fragment.normalOf[triangle.triangle].x]);
  return shown.surface == 1 + 2 * triangle.fragment + fragment.inner[triangle.triangle] &&
         (hit < hits.fronts ? cosine : -cosine) > kSmooth;
}

/// Finds the surfaces of pixel (x, y) of the tile.
void Tile::findShown(int x, int y) const {
  const std::uint32_t* const shown =
      &hits.shown[static_cast<std::size_t>(kSamplesPerPixel * (y * kTile + x))];
  const auto positionOf = [&](std::size_t sample) {
    return kInPixel[sample] + glm::vec2(static_cast<float>(x0 + x), static_cast<float>(y0 + y));
  };
  const PixelSurfaces found = pixel(x, y);
  found[0].surface = kNoSurface;
  if (std::all_of(shown, shown + kSamplesPerPixel, [&](auto hit) { return hit == shown[0]; })) {
    if (shown[0] != TileHits::kNothing) found[0] = shownBy(shown[0], positionOf(0));
    return;
  }
  std::size_t count = 0;
  for (std::size_t s = 0; s < kSamplesPerPixel; ++s) {
    if (shown[s] == TileHits::kNothing) continue;
    std::size_t same = 0;
    while (same < count && !isPartOf(found[same], shown[s])) ++same;
    if (same < count) {
      ++found[same].samples;
      continue;
    }
    if (count > 0) found[count - 1].isLast = false;
    found[count] = shownBy(shown[s], positionOf(s));
    found[count++].samples = 1;
  }
}

/// Returns the index of the first light point of a square of the tile.
std::size_t Tile::pointsOf(int squareX, int squareY) const {
  return static_cast<std::size_t>(Band::kPointsPerSquare *
                                  (squareY * tracer.squares() + x0 / 2 + squareX));
}

/// Returns the key light that the traced squares beside this one agree on.
std::optional<float> Tile::agreedKey(const LightPoint& point, int squareX, int squareY) const {
  const float reach = tracer.camera.reachAt(point.position);
  const int stepX = squareX % 2, stepY = squareY % 2;
  int agreeing = 0;
  float key = 0.0f;
  for (int y = squareY - stepY; y <= squareY + stepY; y += 2)
    for (int x = squareX - stepX; x <= squareX + stepX; x += 2) {
      if (x >= squares || y >= kTile / 2) continue;
      const LightPoint* const others = &band.points[pointsOf(x, y)];
      for (int k = 0; k < Band::kPointsPerSquare && others[k].surface != kNoSurface; ++k) {
        if (!continues(others[k], point.surface, point.position, point.normal, reach)) continue;
        if (agreeing++ == 0) key = others[k].free.x;
        if (others[k].free.x != key) return std::nullopt;
      }
    }
  if (agreeing < 2 || (key != 0.0f && key != 1.0f)) return std::nullopt;
  return key;
}

/// Traces rays to the key light, unless its share is known, and to the sky, in the directions of
/// the square's cell.
void Tile::light(LightPoint& point, std::optional<float> key, glm::vec3 face, int cell) const {
  const Occluders& occluders = tracer.occluders;
  const glm::vec3 origin = point.position + occluders.lift() * face;
  const auto share = [&](int rays, const auto& direction) {
    float sum = 0.0f;
    for (int i = 0; i < rays; ++i)
      sum += occluders.free(origin, direction(static_cast<std::size_t>(i * kPatternCells + cell)),
                            occluders.start());
    return sum / static_cast<float>(rays);
  };
  if (glm::dot(point.normal, tracer.light.keyDirection) <= 0.0f) key = 0.0f;
  if (!key) key = share(Tracer::kKeyRays, [&](std::size_t i) { return tracer.keys[i]; });
  point.free.x = *key;
  point.free.y = share(Tracer::kSkyRays, [&](std::size_t i) {
    return skyDirection(tracer.skies[i], point.normal, face);
  });
}

/// Lights a square of four pixels: up to two of its surfaces.
void Tile::lightSquare(int squareX, int squareY) const {
  LightPoint* const points = &band.points[pointsOf(squareX, squareY)];
  const bool isFirst = squareX % 2 == 0 && squareY % 2 == 0;
  int count = 0;
  for (int i = 0; i < 4 && count < Band::kPointsPerSquare; ++i) {
    const int x = 2 * squareX + i % 2;
    if (x0 + x >= tracer.width) continue;
    pixel(x, 2 * squareY + i / 2).visit([&](const Shown& shown) {
      const bool isFound = std::any_of(points, points + count, [&](const LightPoint& other) {
        return other.surface == shown.surface && glm::dot(other.normal, shown.normal) > kSmooth;
      });
      if (isFound || count == Band::kPointsPerSquare) return;
      LightPoint& point = points[count++];
      point = {shown.surface, shown.position, shown.normal, {}, {}};
      light(point, isFirst ? std::nullopt : agreedKey(point, squareX, squareY),
            fragmentOf(shown).faceTowards(shown.triangle, tracer.camera.eye),
            patternCell(x0 / 2 + squareX, y0 / 2 + squareY));
    });
  }
  if (count < Band::kPointsPerSquare) points[count].surface = kNoSurface;
}

/// Traces the key light of a quarter of the squares, then of those where these do not agree.
void Tile::lightSquares() const {
  for (const bool first : {true, false})
    for (int y = 0; y < kTile / 2; ++y)
      for (int x = 0; x < squares; ++x)
        if ((x % 2 == 0 && y % 2 == 0) == first) lightSquare(x, y);
}

}  // namespace

Band::Band(int width)
    : covered(static_cast<std::size_t>((width + kTile - 1) / kTile), 0),
      pixels(static_cast<std::size_t>(kTile * width)) {
  shown = std::make_unique_for_overwrite<Shown[]>(kSamplesPerPixel * pixels);
  points = std::make_unique_for_overwrite<LightPoint[]>(
      static_cast<std::size_t>(kPointsPerSquare * (kTile / 2) * ((width + 1) / 2)));
}

void Tracer::trace(int tileX, int tileY, Band& band) const {
  TileHits hits;
  const bool isCovered = raster.draw(tileX, tileY, hits);
  band.covered[static_cast<std::size_t>(tileX)] = isCovered ? 1 : 0;
  if (!isCovered) return;
  const int columns = std::min(kTile, width - tileX * kTile);
  const Tile tile{*this, tileX * kTile, tileY * kTile, hits, band, (columns + 1) / 2};
  for (int y = 0; y < kTile; ++y)
    for (int x = 0; x < columns; ++x) tile.findShown(x, y);
  tile.lightSquares();
}

}  // namespace sherd
