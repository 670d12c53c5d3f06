// Renders fragments band by band: traces a band of rows, smooths its light, shades it.
#include <sherd/error.h>
#include <sherd/render.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <new>
#include <string>

#include "render/aovs.h"
#include "render/camera.h"
#include "render/light.h"
#include "render/palette.h"
#include "render/scene.h"
#include "render/trace.h"

namespace sherd {
namespace {

constexpr int kReach = 2;  // radius of the light's smoothing, pixels

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

class Renderer {
 public:
  Renderer(std::span<const Fragment> fragments, const RenderOptions& options)
      : width_(options.width),
        height_(options.height),
        scene_(makeScene(fragments, options)),
        camera_(frameScene(scene_, options)),
        light_(
            makeLight(static_cast<float>(std::fmod(options.azimuth, 360.0) * kRadiansPerDegree))),
        coverage_(scene_, camera_),
        ground_(scene_, light_) {
    for (const Fragment& fragment : fragments)
      colors_.push_back(fragmentColor(std::max(0, fragment.id - 1)));
  }

  Image render(const Progress* progress) const {
    Image image{width_, height_, std::vector<std::uint8_t>(3 * pixels())};
    forEachPixel(progress, [&](const Bands& ring, int x, int y) {
      const Pixel shaded = shadedPixel(ring, x, y, toneMap);
      const glm::vec3 light = shaded.light + shaded.open * backdrop(x, y);
      std::uint8_t* rgb = &image.rgb[3 * pixelIndex(x, y)];
      for (int k = 0; k < 3; ++k) rgb[k] = byteFromLinear(light[k]);
    });
    return image;
  }

  Aovs renderAovs(std::span<const Fragment> fragments, char up, const Progress* progress) const {
    Aovs aovs{width_, height_, std::vector<float>(4 * pixels()), {}, {}, {}, {}, {}};
    forEachPixel(progress, [&](const Bands& ring, int x, int y) {
      const Pixel shaded = shadedPixel(ring, x, y, [](const glm::vec3& light) { return light; });
      float* rgba = &aovs.rgba[4 * pixelIndex(x, y)];
      for (int k = 0; k < 3; ++k) rgba[k] = shaded.light[k];
      rgba[3] = 1.0f - shaded.open;
    });
    traceCenters(fragments, scene_, camera_, up, aovs);
    return aovs;
  }

 private:
  void trace(int band, Band& target) const {
    tbb::parallel_for(0, (width_ + kTile - 1) / kTile,
                      [&](int tile) { tracer_.trace(tile * kTile, band * kTile, target); });
  }

  using Bands = std::array<Band, 3>;

  std::size_t pixels() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }
  std::size_t pixelIndex(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  // Smoothing reads kReach rows of the next band, so a band is shaded after that is traced.
  template <class Shade>
  void forEachPixel(const Progress* progress, const Shade& shade) const {
    const int bands = (height_ + kTile - 1) / kTile;
    Bands ring{Band(width_), Band(width_), Band(width_)};
    for (int band = 0; band <= bands; ++band) {
      reportProgress(progress, "render", static_cast<double>(band) / (bands + 1));
      if (band < bands) trace(band, ring[static_cast<std::size_t>(band % 3)]);
      if (band == 0) continue;
      const int first = (band - 1) * kTile, last = std::min(height_, first + kTile);
      tbb::parallel_for(first, last, [&](int y) {
        for (int x = 0; x < width_; ++x) shade(ring, x, y);
      });
    }
  }

  /// Index in its band of a sample of pixel (x, y).
  std::size_t sampleIndex(int sample, int x, int y) const {
    return static_cast<std::size_t>((sample * kTile + y % kTile) * width_ + x);
  }

  /// Averages over a pixel's samples.
  struct Pixel {
    glm::vec3 light{0.0f};  ///< 0 for samples without a fragment
    float open = 0.0f;      ///< share of samples without a fragment
  };
  template <class Tone>
  Pixel shadedPixel(const Bands& ring, int x, int y, const Tone& tone) const {
    glm::vec3 sum(0.0f);
    int open = 0;
    for (int s = 0; s < kSamplesPerPixel; ++s) {
      const Band& band = ring[static_cast<std::size_t>(y / kTile % 3)];
      const std::size_t at = sampleIndex(s, x, y);
      if (band.surface[at] == Band::kNothing) {
        ++open;
      } else {
        const glm::vec2 free = smoothed(ring, s, x, y, band.surface[at], band.samples[at]);
        sum += tone(surfaceLight(band.surface[at], band.samples[at], free));
      }
    }
    constexpr float kShare = 1.0f / static_cast<float>(kSamplesPerPixel);
    return {kShare * sum, kShare * static_cast<float>(open)};
  }

  /// Returns the key and sky light at a sample: the mean over nearby samples of the same smooth
  /// surface, each of which traced one direction of the pattern.
  glm::vec2 smoothed(const Bands& ring, int s, int x, int y, std::uint32_t surface,
                     const Sample& sample) const {
    const float tolerance =
        1.5f * camera_.pixel * glm::dot(camera_.eye - sample.position, camera_.back);
    glm::vec2 sum(0.0f);
    float weights = 0.0f;
    for (int ny = std::max(0, y - kReach); ny <= std::min(height_ - 1, y + kReach); ++ny) {
      const Band& band = ring[static_cast<std::size_t>(ny / kTile % 3)];
      const float rowWeight = std::abs(ny - y) == kReach ? 0.5f : 1.0f;
      for (int nx = std::max(0, x - kReach); nx <= std::min(width_ - 1, x + kReach); ++nx) {
        const std::size_t at = sampleIndex(s, nx, ny);
        if (band.surface[at] != surface) continue;
        const Sample& other = band.samples[at];
        if (glm::dot(other.normal, sample.normal) < 0.9f ||
            std::abs(glm::dot(sample.normal, other.position - sample.position)) > tolerance)
          continue;
        const float weight = std::abs(nx - x) == kReach ? 0.5f * rowWeight : rowWeight;
        sum += weight * glm::vec2(other.key, other.sky);
        weights += weight;
      }
    }
    return weights > 0.0f ? sum / weights : glm::vec2(sample.key, sample.sky);
  }

  glm::vec3 surfaceLight(std::uint32_t surface, const Sample& sample, glm::vec2 free) const {
    const bool inner = (surface - 1) % 2 != 0;
    const FragmentColor& color = colors_[(surface - 1) / 2];
    const glm::vec3 albedo = inner ? color.inner : color.outer;
    const glm::vec3 n = sample.normal;
    const glm::vec3 below = light_.ground * ground_.at(sample.position.x, sample.position.z);
    const glm::vec3 around =
        glm::mix(below, light_.sky, 0.5f + 0.5f * n.y) * withBounces(free.y, albedo);
    const float cosine = std::max(0.0f, glm::dot(n, light_.keyDirection));
    glm::vec3 light = albedo * (light_.key * (cosine * free.x) + around);
    if (!inner) {
      // The original surface has a faint sheen, a fracture surface has none.
      const glm::vec3 view = glm::normalize(camera_.eye - sample.position);
      const float h = std::max(0.0f, glm::dot(n, glm::normalize(view + light_.keyDirection)));
      const float h8 = h * h * h * h * h * h * h * h, h32 = h8 * h8 * h8 * h8;
      const float graze = 1.0f - std::max(0.0f, glm::dot(n, view));
      light += light_.key * (0.10f * h32 * cosine * free.x);
      light += light_.sky * (0.22f * graze * graze * graze * graze * free.y);
    }
    return light;
  }

  /// Returns the backdrop: bright paper, darker towards the corners, with the fragments' shadow.
  glm::vec3 backdrop(int x, int y) const {
    const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width_) - 0.5f;
    const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height_) - 0.44f;
    const glm::vec3 middle(0.890f, 0.878f, 0.855f), corner(0.700f, 0.690f, 0.675f);
    const glm::vec3 paper =
        glm::mix(middle, corner, glm::smoothstep(0.1f, 0.85f, std::sqrt(u * u + v * v)));
    const glm::vec3 d =
        camera_.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    const float drop = camera_.eye.y - scene_.groundY;
    if (d.y >= 0.0f || drop <= 0.0f) return paper;
    const float t = drop / -d.y;
    return paper * ground_.at(camera_.eye.x + t * d.x, camera_.eye.z + t * d.z);
  }

  int width_, height_;
  Scene scene_;
  Camera camera_;
  Light light_;
  Coverage coverage_;
  GroundLight ground_;
  Tracer tracer_{scene_, camera_, light_, coverage_, width_};
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
