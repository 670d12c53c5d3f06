// Which triangle each sample of an image shows.
#include "render/raster.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace sherd {
namespace {

// One lane for each sample of a pixel.
using Floats = float __attribute__((vector_size(16)));
using Ints = std::int32_t __attribute__((vector_size(16)));

constexpr Floats kSampleX = {kInPixel[0].x, kInPixel[1].x, kInPixel[2].x, kInPixel[3].x};
constexpr Floats kSampleY = {kInPixel[0].y, kInPixel[1].y, kInPixel[2].y, kInPixel[3].y};

bool any(Ints mask) {
  std::array<std::int64_t, 2> halves;
  std::memcpy(halves.data(), &mask, sizeof mask);
  return (halves[0] | halves[1]) != 0;
}

Floats spread(float value) { return Floats{value, value, value, value}; }

/// Twice the signed area; positive for triangles that face the camera, as y points down.
float doubleArea(glm::vec2 a, glm::vec2 b, glm::vec2 c) {
  return (c.x - a.x) * (b.y - a.y) - (b.x - a.x) * (c.y - a.y);
}

/// A function of the image position that is linear: slopeX * x + slopeY * y + constant.
struct Plane {
  float slopeX, slopeY, constant;
};

/// The distance from edge ab, at least 0 on the side of c if `side` is 1; scaled by its length.
Plane edgePlane(glm::vec2 a, glm::vec2 b, float side, float rounding) {
  const float x = side * (b.y - a.y), y = side * (a.x - b.x);
  return {x, y, -(x * a.x + y * a.y) + rounding * (std::abs(x) + std::abs(y))};
}

/// The depth of a tile's samples, and what they show.
struct DepthTile {
  static constexpr int kBlock = 8;  // pixels along the side of a block with a common least depth
  static constexpr int kBlocks = kTile / kBlock;

  alignas(16) std::array<float, kSamplesPerPixel * kTile * kTile> near{};  // 1 / depth
  std::array<float, static_cast<std::size_t>(kBlocks* kBlocks)> farthest{};

  /// Sets `farthest`; until then nothing is hidden.
  void findFarthest() {
    for (int b = 0; b < kBlocks * kBlocks; ++b) {
      float least = std::numeric_limits<float>::infinity();
      for (int y = 0; y < kBlock; ++y) {
        const int row = (b / kBlocks * kBlock + y) * kTile + b % kBlocks * kBlock;
        for (int i = 0; i < kSamplesPerPixel * kBlock; ++i)
          least = std::min(least, near[static_cast<std::size_t>(kSamplesPerPixel * row + i)]);
      }
      farthest[static_cast<std::size_t>(b)] = least;
    }
  }

  bool isHidden(glm::ivec2 low, glm::ivec2 high, float nearest) const {
    for (int y = low.y / kBlock; y <= high.y / kBlock; ++y)
      for (int x = low.x / kBlock; x <= high.x / kBlock; ++x)
        if (nearest > farthest[static_cast<std::size_t>(y * kBlocks + x)]) return false;
    return true;
  }

  void draw(const std::array<glm::vec3, 3>& corners, float rounding, std::uint32_t number,
            TileHits& hits);
};

/// Draws a triangle whose corners are relative to the tile.
void DepthTile::draw(const std::array<glm::vec3, 3>& corners, float rounding, std::uint32_t number,
                     TileHits& hits) {
  const glm::vec3 &a = corners[0], &b = corners[1], &c = corners[2];
  const glm::vec3 least = glm::min(a, glm::min(b, c)), most = glm::max(a, glm::max(b, c));
  const auto pixel = [](float position) {
    return static_cast<int>(std::clamp(position, 0.0f, static_cast<float>(kTile - 1)));
  };
  const glm::ivec2 low(pixel(least.x - rounding), pixel(least.y - rounding));
  const glm::ivec2 high(pixel(most.x + rounding), pixel(most.y + rounding));
  const float area = doubleArea(glm::vec2(a), glm::vec2(b), glm::vec2(c));
  if (area == 0.0f || isHidden(low, high, most.z)) return;

  const float side = area > 0.0f ? 1.0f : -1.0f;
  const Plane ofC = edgePlane(glm::vec2(a), glm::vec2(b), side, rounding);
  const Plane ofA = edgePlane(glm::vec2(b), glm::vec2(c), side, rounding);
  const Plane ofB = edgePlane(glm::vec2(c), glm::vec2(a), side, rounding);
  // 1 / depth is linear in the image.
  const float share = 1.0f / std::abs(area);
  const float slopeX = share * (ofB.slopeX * (b.z - a.z) + ofC.slopeX * (c.z - a.z));
  const float slopeY = share * (ofB.slopeY * (b.z - a.z) + ofC.slopeY * (c.z - a.z));
  const float constant = a.z - slopeX * a.x - slopeY * a.y;
  const Floats lowest = spread(least.z), highest = spread(most.z);

  const Ints numbers = Ints{} + static_cast<std::int32_t>(number);
  const Floats firstX = kSampleX + static_cast<float>(low.x);
  for (int y = low.y; y <= high.y; ++y) {
    const Floats atY = kSampleY + static_cast<float>(y);
    Floats inA = ofA.slopeX * firstX + ofA.slopeY * atY + ofA.constant;
    Floats inB = ofB.slopeX * firstX + ofB.slopeY * atY + ofB.constant;
    Floats inC = ofC.slopeX * firstX + ofC.slopeY * atY + ofC.constant;
    Floats depth = slopeX * firstX + slopeY * atY + constant;
    std::size_t at = static_cast<std::size_t>(kSamplesPerPixel * (y * kTile + low.x));
    for (int x = low.x; x <= high.x; ++x, at += kSamplesPerPixel) {
      const Ints inside = (inA >= 0.0f) & (inB >= 0.0f) & (inC >= 0.0f);
      if (any(inside)) {
        Floats old;
        Ints shown;
        std::memcpy(&old, &near[at], sizeof old);
        std::memcpy(&shown, &hits.shown[at], sizeof shown);
        // A sliver's slope is not accurate.
        Floats here = depth > lowest ? depth : lowest;
        here = here < highest ? here : highest;
        const Ints nearer = inside & (here > old);
        here = nearer ? here : old;
        shown = nearer ? numbers : shown;
        std::memcpy(&near[at], &here, sizeof here);
        std::memcpy(&hits.shown[at], &shown, sizeof shown);
      }
      inA += ofA.slopeX, inB += ofB.slopeX, inC += ofC.slopeX, depth += slopeX;
    }
  }
}

}  // namespace

Raster::Raster(const Scene& scene, const Camera& camera)
    : scene_(scene),
      rounding_(4e-4f + 1e-6f * std::max(camera.halfWidth, camera.halfHeight)),
      tiles_((static_cast<int>(2.0f * camera.halfWidth) + kTile - 1) / kTile,
             (static_cast<int>(2.0f * camera.halfHeight) + kTile - 1) / kTile),
      screen_(scene.fragments.size()),
      sorted_(scene.fragments.size()) {
  tbb::parallel_for(std::size_t{0}, scene.fragments.size(), [&](std::size_t i) {
    const std::vector<glm::vec3>& vertices = scene.fragments[i].vertices;
    screen_[i].reserve(vertices.size());
    for (const glm::vec3& v : vertices) screen_[i].push_back(camera.project(v));
    sortTriangles(i);
  });
}

void Raster::sortTriangles(std::size_t i) {
  const std::span<const glm::uvec3> triangles = scene_.fragments[i].triangles;
  const std::vector<glm::vec3>& screen = screen_[i];
  Tiles& tiles = sorted_[i];
  const auto tileOf = [&](glm::vec2 p) {
    constexpr float kShare = 1.0f / kTile;
    return glm::ivec2(
        static_cast<int>(std::clamp(kShare * p.x, 0.0f, static_cast<float>(tiles_.x - 1))),
        static_cast<int>(std::clamp(kShare * p.y, 0.0f, static_cast<float>(tiles_.y - 1))));
  };
  glm::vec2 low(std::numeric_limits<float>::infinity()), high = -low;
  for (std::size_t v = 0; v + 1 < screen.size(); ++v) {
    low = glm::min(low, glm::vec2(screen[v]));
    high = glm::max(high, glm::vec2(screen[v]));
  }
  if (triangles.empty() || !(low.x <= high.x)) return;
  tiles.low = tileOf(low - rounding_);
  tiles.size = tileOf(high + rounding_) - tiles.low + 1;

  // Each triangle's first and last tile are found twice, which is less work than keeping them.
  const auto forEachTile = [&](auto&& visit) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const glm::uvec3& corner = triangles[t];
      const glm::vec2 a = screen[corner.x], b = screen[corner.y], c = screen[corner.z];
      const glm::ivec2 first = tileOf(glm::min(a, glm::min(b, c)) - rounding_) - tiles.low;
      const glm::ivec2 last = tileOf(glm::max(a, glm::max(b, c)) + rounding_) - tiles.low;
      const int back = doubleArea(a, b, c) > 0.0f ? 0 : 1;
      for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x)
          visit(static_cast<std::size_t>(2 * (y * tiles.size.x + x) + back), t);
    }
  };
  const auto lists = static_cast<std::size_t>(2 * tiles.size.x * tiles.size.y);
  std::vector<std::uint32_t> first(lists + 2, 0);
  forEachTile([&](std::size_t list, std::uint32_t) { ++first[list + 2]; });
  for (std::size_t list = 2; list < first.size(); ++list) first[list] += first[list - 1];
  tiles.triangles.resize(first.back());
  forEachTile([&](std::size_t list, std::uint32_t t) { tiles.triangles[first[list + 1]++] = t; });
  first.pop_back();
  tiles.first = std::move(first);
}

bool Raster::draw(int tileX, int tileY, TileHits& hits) const {
  hits.triangles.clear();
  const auto add = [&](int back) {
    for (std::size_t i = 0; i < sorted_.size(); ++i) {
      const Tiles& tiles = sorted_[i];
      const int x = tileX - tiles.low.x, y = tileY - tiles.low.y;
      if (x < 0 || y < 0 || x >= tiles.size.x || y >= tiles.size.y) continue;
      const auto list = static_cast<std::size_t>(2 * (y * tiles.size.x + x) + back);
      for (std::uint32_t k = tiles.first[list]; k < tiles.first[list + 1]; ++k)
        hits.triangles.push_back({static_cast<std::uint32_t>(i), tiles.triangles[k]});
    }
  };
  hits.triangles.push_back({0, 0});
  add(0);
  hits.fronts = hits.triangles.size();
  add(1);
  if (hits.triangles.size() == 1) return false;

  hits.shown.fill(TileHits::kNothing);
  DepthTile tile;
  const glm::vec3 origin(static_cast<float>(tileX * kTile), static_cast<float>(tileY * kTile),
                         0.0f);
  for (std::size_t k = 1; k < hits.triangles.size(); ++k) {
    if (k == hits.fronts) tile.findFarthest();
    const TileHits::Triangle& shown = hits.triangles[k];
    const std::vector<glm::vec3>& screen = screen_[shown.fragment];
    const glm::uvec3& t = scene_.fragments[shown.fragment].triangles[shown.triangle];
    tile.draw({screen[t.x] - origin, screen[t.y] - origin, screen[t.z] - origin}, rounding_,
              static_cast<std::uint32_t>(k), hits);
  }
  return true;
}

glm::vec2 Raster::barycentric(const TileHits::Triangle& triangle, glm::vec2 position) const {
  const std::vector<glm::vec3>& screen = screen_[triangle.fragment];
  const glm::uvec3& t = scene_.fragments[triangle.fragment].triangles[triangle.triangle];
  const glm::vec3 &a = screen[t.x], &b = screen[t.y], &c = screen[t.z];
  const float area = doubleArea(glm::vec2(a), glm::vec2(b), glm::vec2(c));
  // The rounding of edges, and slivers, may put a sample outside of its triangle.
  const float v = std::clamp(doubleArea(glm::vec2(c), glm::vec2(a), position) / area, 0.0f, 1.0f);
  const float w =
      std::clamp(doubleArea(glm::vec2(a), glm::vec2(b), position) / area, 0.0f, 1.0f - v);
  const float atB = v * b.z, atC = w * c.z;  // linear in the image once divided by the depth
  const float sum = (1.0f - v - w) * a.z + atB + atC;
  return {atB / sum, atC / sum};
}

}  // namespace sherd
