// Traces the samples of an image, and which light reaches them.
#include "render/trace.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace sherd {
namespace {

/// Sample positions in a pixel: a rotated grid, one per row and column.
constexpr std::array<glm::vec2, kSamplesPerPixel> kInPixel = {
    {{0.375f, 0.125f}, {0.875f, 0.375f}, {0.125f, 0.625f}, {0.625f, 0.875f}}};

/// 16x8 pixels.  A packet of shadow rays covers eight pixels four apart, which share a direction; a
/// packet of camera rays covers two whole pixels, which hit the same triangles (measured: a third
/// of the time).
struct Block {
  const Tracer& tracer;
  int x0, y0;  ///< upper left pixel
  int row0;    ///< the band's first row
  Band& band;
  /// Unit face normals at the hits, towards the camera.
  std::array<glm::vec3, kSamplesPerPixel * Coverage::kWidth * Coverage::kHeight> faces;

  /// Index of a sample in `faces`, and in the band.
  static std::size_t inBlock(int sample, int x, int y) {
    return static_cast<std::size_t>((sample * Coverage::kHeight + y) * Coverage::kWidth + x);
  }
  std::size_t inBand(int sample, int x, int y) const {
    return static_cast<std::size_t>((sample * kTile + y0 - row0 + y) * tracer.width + x0 + x);
  }

  void tracePixels(int x, int y);
  void lightPixels(int cellX, int cellY, int sample);
};

/// Traces the camera rays of pixels (x, y) and (x + 1, y) of the block.
void Block::tracePixels(int x, int y) {
  alignas(32) std::array<int, 8> valid;
  RTCRayHit8 hits;
  for (int i = 0; i < 8; ++i) {
    const glm::vec2 at = kInPixel[static_cast<std::size_t>(i % 4)] +
                         glm::vec2(static_cast<float>(x0 + x + i / 4), static_cast<float>(y0 + y));
    const glm::vec3 d = tracer.camera.direction(at.x, at.y), eye = tracer.camera.eye;
    hits.ray.org_x[i] = eye.x, hits.ray.org_y[i] = eye.y, hits.ray.org_z[i] = eye.z;
    hits.ray.dir_x[i] = d.x, hits.ray.dir_y[i] = d.y, hits.ray.dir_z[i] = d.z;
    hits.ray.tnear[i] = 0.0f, hits.ray.tfar[i] = std::numeric_limits<float>::infinity();
    hits.ray.mask[i] = ~0u, hits.ray.flags[i] = 0, hits.ray.time[i] = 0.0f;
    hits.hit.geomID[i] = hits.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    valid[static_cast<std::size_t>(i)] = x0 + x + i / 4 < tracer.width ? -1 : 0;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid.data(), tracer.scene.embree.get(), &context, &hits);

  for (int i = 0; i < 8; ++i) {
    if (!valid[static_cast<std::size_t>(i)] || hits.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID)
      continue;
    const SceneFragment& fragment = tracer.scene.fragments[hits.hit.geomID[i]];
    const unsigned triangle = hits.hit.primID[i];
    const float u = hits.hit.u[i], v = hits.hit.v[i], w = 1.0f - u - v;
    glm::vec3 face =
        glm::normalize(glm::vec3(hits.hit.Ng_x[i], hits.hit.Ng_y[i], hits.hit.Ng_z[i]));
    const glm::vec3 ray(hits.ray.dir_x[i], hits.ray.dir_y[i], hits.ray.dir_z[i]);
    if (glm::dot(face, ray) > 0.0f) face = -face;

    const std::size_t at = inBand(i % 4, x + i / 4, y);
    band.surface[at] = 1 + 2 * hits.hit.geomID[i] + fragment.inner[triangle];
    Sample& sample = band.samples[at];
    // Interpolated from the corners, which is more accurate than along the ray.
    const glm::uvec3& t = fragment.triangles[triangle];
    sample.position =
        w * fragment.vertices[t.x] + u * fragment.vertices[t.y] + v * fragment.vertices[t.z];
    sample.normal = fragment.normalAt(triangle, u, v);
    if (glm::dot(face, sample.normal) < 0.0f) sample.normal = -sample.normal;
    faces[inBlock(i % 4, x + i / 4, y)] = face;
  }
}

/// Rotates a direction about +z to the smooth normal, and reflects it above the face.
glm::vec3 skyDirection(glm::vec3 d, glm::vec3 normal, glm::vec3 face) {
  const Frame frame = frameAround(normal);
  const glm::vec3 rotated = d.x * frame.x + d.y * frame.y + d.z * frame.z;
  const float below = std::min(0.0f, glm::dot(rotated, face));
  return rotated - 2.0f * below * face;
}

/// Traces key and sky light for one sample of the block's pixels in one cell of the pattern.
void Block::lightPixels(int cellX, int cellY, int sample) {
  ShadowPacket key, sky;
  std::array<Sample*, 8> target{};
  bool any = false;
  const std::size_t direction =
      static_cast<std::size_t>(sample * kPatternCells + patternCell(cellX, cellY));
  for (int i = 0; i < 8; ++i) {
    const int x = cellX + kPatternSize * (i % 4), y = cellY + kPatternSize * (i / 4);
    if (x0 + x >= tracer.width || band.surface[inBand(sample, x, y)] == Band::kNothing) continue;
    any = true;
    const std::size_t lane = static_cast<std::size_t>(i);
    target[lane] = &band.samples[inBand(sample, x, y)];
    const glm::vec3 face = faces[inBlock(sample, x, y)], normal = target[lane]->normal;
    const glm::vec3 origin = target[lane]->position + kLift * face;
    if (glm::dot(normal, tracer.light.keyDirection) > 0.0f)
      key.set(lane, origin, tracer.keys[direction]);
    sky.set(lane, origin, skyDirection(tracer.skies[direction], normal, face));
  }
  if (!any) return;
  const RTCScene scene = tracer.scene.embree.get();
  const auto keyFree = key.free(scene, RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  const auto skyFree = sky.free(scene, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  for (std::size_t lane = 0; lane < 8; ++lane)
    if (target[lane]) target[lane]->key = keyFree[lane], target[lane]->sky = skyFree[lane];
}

}  // namespace

Coverage::Coverage(const Scene& scene, const Camera& camera)
    : columns_((static_cast<int>(2.0f * camera.halfWidth) + kTile - 1) / kTile * (kTile / kWidth)),
      rows_((static_cast<int>(2.0f * camera.halfHeight) + kTile - 1) / kTile * (kTile / kHeight)),
      covered_(static_cast<std::size_t>(columns_ * rows_), 0) {
  const auto cell = [](float position, int size, int count) {
    return std::clamp(static_cast<int>(std::floor(position / static_cast<float>(size))), 0,
                      count - 1);
  };
  std::vector<glm::vec2> projected;
  for (const SceneFragment& fragment : scene.fragments) {
    projected.clear();
    for (const glm::vec3& v : fragment.vertices) projected.push_back(camera.project(v));
    for (const glm::uvec3& t : fragment.triangles) {
      const glm::vec2 a = projected[t.x], b = projected[t.y], c = projected[t.z];
      constexpr float kRounding = 0.05f;  // pixels, far above the error of projection in floats
      const glm::vec2 low = glm::min(a, glm::min(b, c)) - kRounding;
      const glm::vec2 high = glm::max(a, glm::max(b, c)) + kRounding;
      const int left = cell(low.x, kWidth, columns_), right = cell(high.x, kWidth, columns_);
      const int bottom = cell(high.y, kHeight, rows_);
      for (int y = cell(low.y, kHeight, rows_); y <= bottom; ++y)
        for (int x = left; x <= right; ++x)
          covered_[static_cast<std::size_t>(y * columns_ + x)] = 1;
    }
  }
}

void Tracer::trace(int x0, int y0, Band& band) const {
  const int x1 = std::min(x0 + kTile, width);
  for (std::size_t row = 0; row < kSamplesPerPixel * kTile; ++row) {
    std::uint32_t* const first = &band.surface[row * static_cast<std::size_t>(width)];
    std::fill(first + x0, first + x1, Band::kNothing);
  }
  for (int y = y0; y < y0 + kTile; y += Coverage::kHeight)
    for (int x = x0; x < x1; x += Coverage::kWidth) {
      if (!coverage.at(x, y)) continue;
      Block block{*this, x, y, y0, band, {}};
      for (int v = 0; v < Coverage::kHeight; ++v)
        for (int u = 0; u < Coverage::kWidth; u += 2) block.tracePixels(u, v);
      for (int sample = 0; sample < kSamplesPerPixel; ++sample)
        for (int v = 0; v < kPatternSize; ++v)
          for (int u = 0; u < kPatternSize; ++u) block.lightPixels(u, v, sample);
    }
}

}  // namespace sherd
