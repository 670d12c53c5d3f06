// Renders fragments band by band: finds what a band of rows shows, traces and smooths its light,
// shades it.
#include <sherd/error.h>
#include <sherd/render.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <new>
#include <span>
#include <string>

#include "render/aovs.h"
#include "render/backdrop.h"
#include "render/camera.h"
#include "render/light.h"
#include "render/occluders.h"
#include "render/palette.h"
#include "render/raster.h"
#include "render/scene.h"
#include "render/trace.h"

namespace sherd {
namespace {

constexpr int kReach = 2;  // radius of the light's smoothing, squares of 2x2 pixels

void checkOptions(const RenderOptions& options) {
  const auto fail = [](const std::string& sentence) { throw Error(ErrorCode::usage, sentence); };
  if (std::min(options.width, options.height) < 16 ||
      std::max(options.width, options.height) > 16384)
    fail("image: size is " + std::to_string(options.width) + "x" + std::to_string(options.height) +
         ", expected 16 to 16384 pixels for each side");
  if (!(options.explode >= 0.0 && options.explode <= 100.0))
    fail("image: explode is " + std::to_string(options.explode) + ", expected 0 to 100");
  if (!(std::abs(options.elevation) <= 90.0))
    fail("image: elevation is " + std::to_string(options.elevation) +
         ", expected -90 to 90 degrees");
  if (!(options.zoom >= 0.01 && options.zoom <= 1000.0))
    fail("image: zoom is " + std::to_string(options.zoom) + ", expected 0.01 to 1000");
  if (!std::isfinite(options.azimuth)) fail("image: azimuth is not a finite number");
  if (options.up != 'x' && options.up != 'y' && options.up != 'z')
    fail(std::string("image: up axis is '") + options.up + "', expected x, y or z");
}

/// Ambient occlusion with interreflection, which keeps hollows from turning gray.
/// source  J. Jimenez et al., Practical Real-Time Strategies for Accurate Indirect Occlusion, 2016
glm::vec3 withBounces(float sky, glm::vec3 albedo) {
  const glm::vec3 a = 2.0404f * albedo - 0.3324f, b = -4.7951f * albedo + 0.6417f,
                  c = 2.7552f * albedo + 0.6903f;
  const float open = 0.05f + 0.95f * sky;  // some light reaches every hollow
  return glm::max(glm::vec3(open), ((open * a + b) * open + c) * open);
}

/// Side of the cubes that the occluders' vertices merge in: some pixels, and less in small images.
float occluderCell(const Camera& camera) {
  constexpr float kPixels = 8.0f, kMost = 0.025f;
  return std::min(kPixels * camera.pixel * glm::length(camera.eye), kMost);
}

std::vector<int> idsOf(std::span<const Fragment> fragments) {
  std::vector<int> ids;
  for (const Fragment& fragment : fragments) ids.push_back(fragment.id);
  return ids;
}

class Renderer {
 public:
  Renderer(std::span<const Fragment> fragments, const RenderOptions& options)
      : width_(options.width),
        height_(options.height),
        scene_(makeScene(fragments, options)),
        camera_(frameScene(scene_, idsOf(fragments), options)),
        light_(
            makeLight(static_cast<float>(std::fmod(options.azimuth, 360.0) * kRadiansPerDegree))),
        raster_(scene_, camera_),
        occluders_(scene_, occluderCell(camera_)),
        ground_(scene_, light_, occluders_) {
    for (const Fragment& fragment : fragments)
      colors_.push_back(fragmentColor(std::max(0, fragment.id - 1)));
  }

  Image render(const Progress* progress) const {
    Image image{width_, height_, std::vector<std::uint8_t>(3 * pixels())};
    const Backdrop backdrop(camera_, ground_, scene_.groundY);
    const auto prepare = [&](int row) { backdrop.fill(row, image.rgb); };
    forEachPixel(
        progress, prepare, [&](const PixelSurfaces& surfaces, const Nearby& rows, int x, int y) {
          const Pixel shaded = shadedPixel(surfaces, rows, x, toneMap);
          glm::vec3 light = shaded.light;
          if (shaded.open > 0.0f)
            light += shaded.open *
                     backdrop.at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
          std::uint8_t* rgb = &image.rgb[3 * pixelIndex(x, y)];
          for (int k = 0; k < 3; ++k) rgb[k] = byteFromLinear(light[k]);
        });
    return image;
  }

  Aovs renderAovs(std::span<const Fragment> fragments, char up, const Progress* progress) const {
    Aovs aovs{width_, height_, std::vector<float>(4 * pixels()), {}, {}, {}, {}, {}};
    forEachPixel(
        progress, [](int) {},
        [&](const PixelSurfaces& surfaces, const Nearby& rows, int x, int y) {
          const Pixel shaded =
              shadedPixel(surfaces, rows, x, [](const glm::vec3& light) { return light; });
          float* rgba = &aovs.rgba[4 * pixelIndex(x, y)];
          for (int k = 0; k < 3; ++k) rgba[k] = shaded.light[k];
          rgba[3] = 1.0f - shaded.open;
        });
    traceCenters(fragments, scene_, camera_, up, aovs);
    return aovs;
  }

 private:
  using Bands = std::array<Band, 3>;  // band b is ring[b % 3]

  static constexpr int kSquareRows = kTile / 2;  // in a band

  /// A row of squares.
  struct Squares {
    LightPoint* points;
    const std::uint8_t* covered;

    /// Returns the points of a square; null where no fragment is near.
    LightPoint* at(int x) const {
      return covered[x / kSquareRows] ? points + Band::kPointsPerSquare * x : nullptr;
    }
    /// Calls visit for each point of a square.
    template <class Visit>
    void visit(int x, const Visit& visit) const {
      LightPoint* const first = at(x);
      for (int k = 0; first && k < Band::kPointsPerSquare && first[k].surface != kNoSurface; ++k)
        visit(first[k]);
    }
  };

  /// The squares that the light of a row of pixels is interpolated between.
  struct Nearby {
    Squares own, beside;
  };

  std::size_t pixels() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }
  std::size_t pixelIndex(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  void trace(int band, Band& target) const {
    tbb::parallel_for(0, (width_ + kTile - 1) / kTile,
                      [&](int tile) { tracer_.trace(tile, band, target); });
  }

  // The light of a square is smoothed once the two rows below are traced, and a pixel is shaded
  // once the squares around it are smooth.
  //   prepare  called for each Backdrop::kRows rows, before their covered pixels are shaded
  template <class Prepare, class Shade>
  void forEachPixel(const Progress* progress, const Prepare& prepare, const Shade& shade) const {
    const int bands = (height_ + kTile - 1) / kTile;
    Bands ring{Band(width_), Band(width_), Band(width_)};
    int smoothed = 0, shaded = 0;  // rows
    for (int band = 0; band < bands; ++band) {
      reportProgress(progress, "render", static_cast<double>(band) / bands);
      trace(band, ring[static_cast<std::size_t>(band % 3)]);
      const bool isLast = band + 1 == bands;
      const int end = (band + 1) * kSquareRows, toSmooth = isLast ? end : end - kReach;
      tbb::parallel_for(smoothed, toSmooth, [&](int row) { smoothRow(ring, row, end); });
      smoothed = toSmooth;
      const int toShade = isLast ? height_ : end * 2 - Backdrop::kRows;
      tbb::parallel_for(shaded / Backdrop::kRows, (toShade + Backdrop::kRows - 1) / Backdrop::kRows,
                        [&](int group) {
                          const int first = group * Backdrop::kRows;
                          prepare(first);
                          for (int y = first; y < std::min(height_, first + Backdrop::kRows); ++y)
                            shadeRow(ring, y, shade);
                        });
      shaded = toShade;
    }
  }

  template <class Shade>
  void shadeRow(const Bands& ring, int y, const Shade& shade) const {
    const Band& band = ring[static_cast<std::size_t>(y / kTile % 3)];
    const int own = y / 2;
    const int beside = std::clamp(own + (y % 2 == 0 ? -1 : 1), 0, (height_ - 1) / 2);
    const Nearby rows{squaresOf(ring, own), squaresOf(ring, beside)};
    for (std::size_t tile = 0; tile < band.covered.size(); ++tile) {
      if (!band.covered[tile]) continue;
      const int first = static_cast<int>(tile) * kTile;
      for (int x = first; x < std::min(width_, first + kTile); ++x) {
        const PixelSurfaces here = band.surfaces(y % kTile * width_ + x);
        if (here[0].surface != kNoSurface) shade(here, rows, x, y);
      }
    }
  }

  Squares squaresOf(const Bands& ring, int y) const {
    const Band& band = ring[static_cast<std::size_t>(y / kSquareRows % 3)];
    return {&band.points[static_cast<std::size_t>(Band::kPointsPerSquare * (y % kSquareRows) *
                                                  tracer_.squares())],
            band.covered.data()};
  }

  /// Sets the smoothed light of a row of squares: the mean over nearby points of the same smooth
  /// surface, each of which traced some directions of the pattern.
  ///   end  first row of squares that is not yet traced
  void smoothRow(const Bands& ring, int y, int end) const {
    std::array<Squares, 2 * kReach + 1> rows;
    const int first = std::max(0, y - kReach), last = std::min(end - 1, y + kReach);
    for (int near = first; near <= last; ++near)
      rows[static_cast<std::size_t>(near - first)] = squaresOf(ring, near);
    const std::span<const Squares> around(rows.data(), static_cast<std::size_t>(last - first + 1));
    const Squares& row = around[static_cast<std::size_t>(y - first)];
    for (int x = 0; x < tracer_.squares(); ++x)
      row.visit(x,
                [&](LightPoint& point) { point.smoothed = smoothed(around, y - first, x, point); });
  }

  ///   rows  the squares around the point's own, which is in rows[y]
  glm::vec2 smoothed(std::span<const Squares> rows, int y, int x, const LightPoint& point) const {
    constexpr float kEnough = 3.0f;  // a few directions alone would give specks
    const float reach = camera_.reachAt(point.position);
    glm::vec2 sum(0.0f), anySum(0.0f);
    float weights = 0.0f, anyWeights = 0.0f;
    const int left = std::max(0, x - kReach), right = std::min(tracer_.squares() - 1, x + kReach);
    for (int ny = 0; ny < static_cast<int>(rows.size()); ++ny) {
      const float rowWeight = std::abs(ny - y) == kReach ? 0.5f : 1.0f;
      for (int nx = left; nx <= right; ++nx) {
        const float weight = std::abs(nx - x) == kReach ? 0.5f * rowWeight : rowWeight;
        rows[static_cast<std::size_t>(ny)].visit(nx, [&](const LightPoint& other) {
          if (other.surface != point.surface) return;
          anySum += weight * other.free;
          anyWeights += weight;
          if (!continues(other, point.surface, point.position, point.normal, reach)) return;
          sum += weight * other.free;
          weights += weight;
        });
      }
    }
    return weights >= kEnough ? sum / weights : anySum / anyWeights;
  }

  /// Returns the key and sky light at a pixel: interpolated between the squares around it.
  glm::vec2 freeAt(const Nearby& rows, int x, const Shown& shown) const {
    const float reach = camera_.reachAt(shown.position);
    const int own = x / 2;
    const int beside = std::clamp(own + (x % 2 == 0 ? -1 : 1), 0, tracer_.squares() - 1);
    glm::vec2 sum(0.0f);
    float weights = 0.0f;
    const auto add = [&](const Squares& squares, int at, float weight) {
      squares.visit(at, [&](const LightPoint& point) {
        if (!continues(point, shown.surface, shown.position, shown.normal, reach)) return;
        sum += weight * point.smoothed;
        weights += weight;
      });
    };
    add(rows.own, own, 9.0f);
    add(rows.own, beside, 3.0f);
    add(rows.beside, own, 3.0f);
    add(rows.beside, beside, 1.0f);
    if (weights > 0.0f) return sum / weights;
    // A third surface in its square: that of the one in front of it.
    const LightPoint* const points = rows.own.at(own);
    return points && points[0].surface != kNoSurface ? points[0].smoothed : glm::vec2(1.0f);
  }

  /// Averages over a pixel's samples.
  struct Pixel {
    glm::vec3 light{0.0f};  ///< 0 for samples without a fragment
    float open = 0.0f;      ///< share of samples without a fragment
  };
  template <class Tone>
  Pixel shadedPixel(const PixelSurfaces& surfaces, const Nearby& rows, int x,
                    const Tone& tone) const {
    constexpr float kShare = 1.0f / static_cast<float>(kSamplesPerPixel);
    Pixel pixel{glm::vec3(0.0f), 1.0f};
    surfaces.visit([&](const Shown& shown) {
      const float share = kShare * static_cast<float>(shown.samples);
      pixel.light += share * tone(surfaceLight(shown, freeAt(rows, x, shown)));
      pixel.open -= share;
    });
    return pixel;
  }

  glm::vec3 surfaceLight(const Shown& shown, glm::vec2 free) const {
    const bool inner = (shown.surface - 1) % 2 != 0;
    const FragmentColor& color = colors_[(shown.surface - 1) / 2];
    const glm::vec3 albedo = inner ? color.inner : color.outer;
    const glm::vec3 n = shown.normal;
    const glm::vec3 below = light_.ground * ground_.at(shown.position.x, shown.position.z);
    const glm::vec3 around =
        glm::mix(below, light_.sky, 0.5f + 0.5f * n.y) * withBounces(free.y, albedo);
    const float cosine = std::max(0.0f, glm::dot(n, light_.keyDirection));
    glm::vec3 light = albedo * (light_.key * (cosine * free.x) + around);
    if (!inner) {
      // The original surface has a faint sheen, a fracture surface has none.
      const glm::vec3 view = glm::normalize(camera_.eye - shown.position);
      const float h = std::max(0.0f, glm::dot(n, glm::normalize(view + light_.keyDirection)));
      const float h8 = h * h * h * h * h * h * h * h, h32 = h8 * h8 * h8 * h8;
      const float graze = 1.0f - std::max(0.0f, glm::dot(n, view));
      light += light_.key * (0.10f * h32 * cosine * free.x);
      light += light_.sky * (0.22f * graze * graze * graze * graze * free.y);
    }
    return light;
  }

  int width_, height_;
  Scene scene_;
  Camera camera_;
  Light light_;
  Raster raster_;
  Occluders occluders_;
  GroundLight ground_;
  Tracer tracer_{scene_, camera_, light_, raster_, occluders_, width_, height_};
  std::vector<FragmentColor> colors_;
};

template <class Render>
auto withinMemory(const RenderOptions& options, const Progress* progress, const Render& render) {
  checkOptions(options);
  reportProgress(progress, "render", 0.0);
  try {
    return render();
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::output, "image: no memory for " + std::to_string(options.width) + "x" +
                                       std::to_string(options.height) +
                                       " pixels; try a smaller image");
  }
}

}  // namespace

Image renderFragments(std::span<const Fragment> fragments, const RenderOptions& options,
                      const Progress* progress) {
  return withinMemory(options, progress,
                      [&] { return Renderer(fragments, options).render(progress); });
}

Aovs renderAovs(std::span<const Fragment> fragments, const RenderOptions& options,
                const Progress* progress) {
  return withinMemory(options, progress, [&] {
    return Renderer(fragments, options).renderAovs(fragments, options.up, progress);
  });
}

}  // namespace sherd
