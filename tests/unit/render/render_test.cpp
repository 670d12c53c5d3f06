// What a picture shows, and that it is the same picture every time.
#include <gtest/gtest.h>
#include <png.h>
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/fracture.h>
#include <sherd/render.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <numbers>
#include <set>
#include <string>

#include "pipeline/memory_estimate.h"
#include "render/palette.h"
#include "render/preview_fragment.h"
#include "shapes.h"
#include "temp_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

Fragment renderedFragment(int id, TriangleMesh mesh, std::uint16_t neighbor = 0) {
  Fragment fragment;
  fragment.id = id;
  fragment.mass = massProperties(mesh);
  fragment.mesh = std::move(mesh);
  fragment.mesh.neighbor.assign(fragment.mesh.triangles.size(), neighbor);
  return fragment;
}

/// Balls side by side along x, of radius 1 and 2.5 apart.
std::vector<Fragment> rowOfBalls(int count) {
  std::vector<Fragment> fragments;
  for (int i = 0; i < count; ++i)
    fragments.push_back(renderedFragment(i + 1, shapes::ball(1.0, 4, {2.5 * i, 0.0, 0.0})));
  return fragments;
}

struct Pixel {
  int r, g, b;
  int brightness() const { return std::max({r, g, b}); }
  int colorfulness() const { return brightness() - std::min({r, g, b}); }
};

Pixel at(const Image& image, int x, int y) {
  const std::uint8_t* p = &image.rgb[3 * static_cast<std::size_t>(y * image.width + x)];
  return {p[0], p[1], p[2]};
}

/// The backdrop and the shadow on it are gray; fragments are not.
bool showsFragment(const Image& image, int x, int y) { return at(image, x, y).colorfulness() > 30; }

ErrorCode codeOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.code();
  }
  return ErrorCode{0};
}

TEST(Render, GivesTheSameBytesOnAnyNumberOfThreads) {
  const std::vector<Fragment> fragments = rowOfBalls(3);
  const RenderOptions options{.width = 333, .height = 211};
  const Image first = renderFragments(fragments, options);
  EXPECT_EQ(renderFragments(fragments, options).rgb, first.rgb);
  for (const std::size_t threads : {1u, 2u, 5u}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_EQ(renderFragments(fragments, options).rgb, first.rgb) << threads << " threads";
  }
}

// Light changes a color's brightness, hardly its chromaticity: each pixel belongs to the fragment
// whose color's is nearest.
TEST(Render, ShowsEveryFragmentInItsColorAndPlace) {
  constexpr int kCount = 6;
  const Image image =
      renderFragments(rowOfBalls(kCount), {.explode = 0.0, .azimuth = 0.0, .elevation = 0.0});
  const auto chromaticity = [](glm::vec3 c) { return c / (c.x + c.y + c.z); };
  std::vector<std::vector<int>> columns(kCount);  // of each fragment's pixels, ascending
  for (int x = 0; x < image.width; ++x)
    for (int y = 0; y < image.height; ++y) {
      if (!showsFragment(image, x, y)) continue;
      const Pixel p = at(image, x, y);
      glm::vec3 linear;
      for (int k = 0; k < 3; ++k)
        linear[k] = linearFromSrgb(static_cast<float>(k == 0 ? p.r : k == 1 ? p.g : p.b) / 255.0f);
      std::size_t nearest = 0;
      float best = 1e9f;
      for (int i = 0; i < kCount; ++i) {
        const glm::vec3 d = chromaticity(linear) - chromaticity(fragmentColor(i).outer);
        const float distance = d.x * d.x + d.y * d.y + d.z * d.z;
        if (distance < best) best = distance, nearest = static_cast<std::size_t>(i);
      }
      columns[nearest].push_back(x);
    }
  // The camera looks at the row's middle from where the wedge of half angle atan(fit) touches the
  // outermost balls; a ball's picture is an ellipse between the tangents on both sides.
  const double across = std::tan(17.5 * std::numbers::pi / 180.0) * 16.0 / 9.0;
  const double fit = 0.86 * across;
  const double distance = (6.25 + std::sqrt(1.0 + fit * fit)) / fit;
  for (int i = 0; i < kCount; ++i) {
    const double x = 2.5 * i - 6.25, angle = std::atan(x / distance);
    const double half = std::asin(1.0 / std::hypot(x, distance));
    const double middle = 0.5 * (std::tan(angle - half) + std::tan(angle + half));
    const std::vector<int>& found = columns[static_cast<std::size_t>(i)];
    ASSERT_GT(found.size(), 5000u) << "fragment " << i + 1;
    // The median: pixels on edges mix with the backdrop and may look like another's.
    EXPECT_NEAR(found[found.size() / 2] + 0.5, image.width * 0.5 * (1.0 + middle / across), 2.0);
  }
}

TEST(Render, ShowsABallRoundAndCenteredAndAsLargeAsTheMarginAllows) {
  const RenderOptions options{.width = 400, .height = 300};
  const Image image = renderFragments(
      std::vector{renderedFragment(1, shapes::ball(3.0, 6, {7.0, -2.0, 5.0}))}, options);
  int left = image.width, right = -1, top = image.height, bottom = -1, area = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      if (!showsFragment(image, x, y)) continue;
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
      ++area;
    }
  const double width = right - left + 1, height = bottom - top + 1;
  EXPECT_NEAR(width, height, 2.0);
  EXPECT_NEAR(0.5 * (left + right + 1), 200.0, 1.5);
  EXPECT_NEAR(0.5 * (top + bottom + 1), 150.0, 1.5);
  // The edge's pixels, half covered, may fall to either side.
  EXPECT_NEAR(area, std::numbers::pi / 4.0 * width * height, std::numbers::pi * width / 2.0);
  EXPECT_NEAR(height, 0.86 * 300.0, 3.0);
}

TEST(Render, ZoomShowsTheMiddleOfALargerImage) {
  const std::vector<Fragment> balls = rowOfBalls(3);
  const Aovs part = renderAovs(balls, {.width = 96, .height = 64, .zoom = 2.0});
  const Aovs whole = renderAovs(balls, {.width = 192, .height = 128});
  std::size_t shown = 0;
  for (std::size_t y = 0; y < 64; ++y) {
    for (std::size_t x = 0; x < 96; ++x) {
      const std::size_t own = y * 96 + x, there = (y + 32) * 192 + x + 48;
      ASSERT_EQ(part.fragment[own], whole.fragment[there]) << x << ' ' << y;
      if (part.fragment[own] == 0) continue;
      ASSERT_NEAR(part.depth[own], whole.depth[there], 1e-3);
      ++shown;
    }
  }
  EXPECT_GT(shown, 1000u);
}

TEST(Render, FocusFillsTheImageWithAFragment) {
  const std::vector<Fragment> balls = rowOfBalls(5);
  for (const int id : {1, 4}) {
    const Aovs aovs = renderAovs(balls, {.width = 160, .height = 120, .focus = {id}});
    int top = 120, bottom = -1, left = 160, right = -1;
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) {
        if (aovs.fragment[static_cast<std::size_t>(y * 160 + x)] !=
            static_cast<std::uint32_t>(id)) {
          continue;
        }
        top = std::min(top, y), bottom = std::max(bottom, y);
        left = std::min(left, x), right = std::max(right, x);
      }
    }
    EXPECT_NEAR(bottom - top + 1, 0.86 * 120.0, 2.0) << id;
    EXPECT_NEAR(top + bottom + 1, 120.0, 3.0) << id;
    EXPECT_NEAR(left + right + 1, 160.0, 40.0) << id;  // another ball hides a part of it
  }
  const Aovs all = renderAovs(balls, {.width = 160, .height = 120, .focus = {1, 2, 3, 4, 5}});
  const Aovs none = renderAovs(balls, {.width = 160, .height = 120});
  const auto shown = [](const Aovs& aovs) {
    return std::ranges::count_if(aovs.fragment, [](std::uint32_t id) { return id != 0; });
  };
  EXPECT_GE(shown(all), shown(none));
}

TEST(Render, LeavesTheBackdropAloneWhereNothingIs) {
  const RenderOptions options{.width = 320, .height = 200};
  const Image empty = renderFragments({}, options);
  const Image ball = renderFragments(std::vector{renderedFragment(1, shapes::ball(1.0))}, options);
  for (int x = 0; x < options.width; ++x) {
    const Pixel p = at(ball, x, 0), q = at(empty, x, 0);
    EXPECT_EQ(std::tie(p.r, p.g, p.b), std::tie(q.r, q.g, q.b)) << "column " << x;
  }
  for (int y = 0; y < options.height; ++y)
    for (int x = 0; x < options.width; ++x) {
      EXPECT_GT(at(empty, x, y).brightness(), 200);
      EXPECT_LT(at(empty, x, y).colorfulness(), 10);
    }
}

TEST(Render, ThrowsAShadowOnTheGround) {
  const RenderOptions options{.width = 320, .height = 200};
  const Image empty = renderFragments({}, options);
  const Image ball = renderFragments(std::vector{renderedFragment(1, shapes::ball(1.0))}, options);
  int darker = 0, lighter = 0;
  for (int y = 0; y < options.height; ++y)
    for (int x = 0; x < options.width; ++x) {
      if (showsFragment(ball, x, y)) continue;
      const int change = at(ball, x, y).brightness() - at(empty, x, y).brightness();
      if (change < -30) ++darker;
      if (change > 0) ++lighter;
    }
  EXPECT_GT(darker, 500);
  EXPECT_LT(lighter, 50);  // pixels on the ball's own bright edge
}

TEST(Render, DistinguishesInnerFacesFromOuterOnes) {
  const RenderOptions options{.width = 160, .height = 160};
  const Image outer =
      renderFragments(std::vector{renderedFragment(1, shapes::ball(1.0), 0)}, options);
  const Image inner =
      renderFragments(std::vector{renderedFragment(1, shapes::ball(1.0), 2)}, options);
  for (int y = 50; y < 110; ++y)
    for (int x = 50; x < 110; ++x) {
      EXPECT_LT(at(inner, x, y).colorfulness(), at(outer, x, y).colorfulness());
      EXPECT_GE(at(inner, x, y).brightness(), at(outer, x, y).brightness());
    }
}

// Two half balls, seen along their cut: whole, they hide the ground behind it; apart, they show it.
TEST(Render, ExplodingMovesFragmentsApart) {
  const TriangleMesh ball = shapes::ball(1.0, 5);
  std::vector<Fragment> halves(2);
  for (std::size_t side = 0; side < 2; ++side) {
    Fragment& half = halves[side];
    half.id = static_cast<int>(side) + 1;
    half.mesh.vertices = ball.vertices;
    for (const glm::uvec3& t : ball.triangles) {
      const double x = ball.vertices[t.x].x + ball.vertices[t.y].x + ball.vertices[t.z].x;
      if ((x > 0.0) == (side == 1)) half.mesh.triangles.push_back(t);
    }
    half.mesh.neighbor.assign(half.mesh.triangles.size(), 0);
    half.mass.volume = 2.0 / 3.0 * std::numbers::pi;
    half.mass.centroid = {side == 1 ? 0.375 : -0.375, 0.0, 0.0};
  }
  for (Fragment& half : halves) {  // unused vertices would count in the framing
    TriangleMesh used;
    for (const glm::uvec3& t : half.mesh.triangles) {
      const unsigned first = static_cast<unsigned>(used.vertices.size());
      for (int k = 0; k < 3; ++k) used.vertices.push_back(half.mesh.vertices[t[k]]);
      used.triangles.emplace_back(first, first + 1, first + 2);
    }
    half.mesh = used;
  }
  const auto gap = [&](double explode) {
    const Image image = renderFragments(
        halves,
        {.width = 400, .height = 300, .explode = explode, .azimuth = 0.0, .elevation = 0.0});
    int clear = 0;
    for (int x = 0; x < image.width; ++x) clear += !showsFragment(image, x, 150);
    const int left = [&] {
      int x = 0;
      while (!showsFragment(image, x, 150)) ++x;
      return x;
    }();
    const int right = [&] {
      int x = 399;
      while (!showsFragment(image, x, 150)) --x;
      return x;
    }();
    return clear - left - (399 - right);
  };
  EXPECT_EQ(gap(0.0), 0);
  EXPECT_GT(gap(1.0), 20);  // 0.75 between the halves, less what perspective hides
}

TEST(Render, UpAxisTurnsTheWholePicture) {
  const TriangleMesh yUp = shapes::append(shapes::ball(1.0), shapes::cube(0.8, {0.3, 1.6, 0.1}));
  const auto turned = [&](const std::function<glm::dvec3(glm::dvec3)>& turn) {
    TriangleMesh mesh = yUp;
    for (glm::dvec3& v : mesh.vertices) v = turn(v);
    return std::vector{renderedFragment(1, mesh)};
  };
  RenderOptions options{.width = 200, .height = 200, .explode = 0.0};
  const Image expected = renderFragments(turned([](glm::dvec3 v) { return v; }), options);
  options.up = 'z';
  EXPECT_EQ(
      renderFragments(turned([](glm::dvec3 v) { return glm::dvec3(v.x, -v.z, v.y); }), options).rgb,
      expected.rgb);
  options.up = 'x';
  EXPECT_EQ(
      renderFragments(turned([](glm::dvec3 v) { return glm::dvec3(v.y, v.z, v.x); }), options).rgb,
      expected.rgb);
}

TEST(Render, DoesNotDependOnTheUnitOfLength) {
  const RenderOptions options{.width = 160, .height = 90};
  const auto ballOf = [](double scale) {
    return std::vector{
        renderedFragment(1, shapes::transformed(shapes::ball(1.0), scale, glm::dvec3(0.0)))};
  };
  const Image expected = renderFragments(ballOf(1.0), options);
  EXPECT_EQ(renderFragments(ballOf(0x1p-40), options).rgb, expected.rgb);
  EXPECT_EQ(renderFragments(ballOf(0x1p+40), options).rgb, expected.rgb);
}

TEST(Render, SurvivesFragmentsWithoutExtent) {
  TriangleMesh point{std::vector<glm::dvec3>(3, glm::dvec3(5.0)), {{0, 1, 2}}};
  const RenderOptions options{.width = 64, .height = 64};
  EXPECT_EQ(renderFragments(std::vector{renderedFragment(1, point)}, options).rgb.size(),
            64u * 64u * 3u);
  EXPECT_EQ(renderFragments(std::vector{renderedFragment(1, {})}, options).rgb,
            renderFragments({}, options).rgb);
}

// A solid of so many voxels along x, of a mesh that is `length` long.
Solid solidOf(int voxels, double length) {
  Solid solid;
  solid.box = {{0, 0, 0}, {voxels - 1, 0, 0}};
  solid.frame.voxelSize = length / voxels;
  return solid;
}

TEST(Pictured, IsAsItIsWhereVoxelsAreAsLargeAsPixels) {
  const Fragment ball = renderedFragment(3, shapes::ball(1.0, 5), 7);
  const Fragment same = previewFragment(ball, solidOf(900, 2.0));
  EXPECT_EQ(same.id, 3);
  EXPECT_EQ(same.mesh.vertices, ball.mesh.vertices);
  EXPECT_EQ(same.mesh.triangles, ball.mesh.triangles);
  EXPECT_EQ(same.mesh.neighbor, ball.mesh.neighbor);
}

TEST(Pictured, OfAFinerSolidIsCoarserAndLooksTheSame) {
  // Edges of 0.009, cubes of 0.03.
  const Fragment ball = renderedFragment(1, shapes::ball(1.0, 7), 2);
  const double length = 768.0 / 32.0;
  const Fragment coarse = previewFragment(ball, solidOf(2048, length));
  const double cube = length / kPreviewCubes;
  EXPECT_LT(coarse.mesh.triangles.size(), ball.mesh.triangles.size() / 3);
  EXPECT_EQ(coarse.mesh.neighbor, std::vector<std::uint16_t>(coarse.mesh.triangles.size(), 2));
  EXPECT_EQ(coarse.mass.centroid, ball.mass.centroid);
  std::set<std::array<long, 3>> cubes;
  const glm::dvec3 low = bounds(ball.mesh).min;
  for (const glm::dvec3& v : coarse.mesh.vertices) {
    EXPECT_NEAR(glm::length(v), 1.0, cube * cube);  // the mean of points of a cap so large
    const glm::dvec3 at = (v - low) / cube;
    EXPECT_TRUE(
        cubes.insert({static_cast<long>(at.x), static_cast<long>(at.y), static_cast<long>(at.z)})
            .second);
  }
  EXPECT_NEAR(volume(coarse.mesh), shapes::ballVolume(1.0), 0.01 * shapes::ballVolume(1.0));
  const Image fine = renderFragments(std::vector{ball}), few = renderFragments(std::vector{coarse});
  double difference = 0.0;
  for (std::size_t i = 0; i < fine.rgb.size(); ++i)
    difference += std::abs(fine.rgb[i] - few.rgb[i]);
  EXPECT_LT(difference / static_cast<double>(fine.rgb.size()), 0.5);
}

TEST(Render, RefusesOptionsOutOfRange) {
  const auto code = [](RenderOptions options) {
    return codeOf([&] { (void)renderFragments({}, options); });
  };
  EXPECT_EQ(code({.width = 15}), ErrorCode::usage);
  EXPECT_EQ(code({.height = 16385}), ErrorCode::usage);
  EXPECT_EQ(code({.explode = -0.1}), ErrorCode::usage);
  EXPECT_EQ(code({.explode = std::nan("")}), ErrorCode::usage);
  EXPECT_EQ(code({.azimuth = std::nan("")}), ErrorCode::usage);
  EXPECT_EQ(code({.elevation = 90.5}), ErrorCode::usage);
  EXPECT_EQ(code({.up = 'w'}), ErrorCode::usage);
  EXPECT_EQ(code({.zoom = 0.0}), ErrorCode::usage);
  EXPECT_EQ(code({.zoom = std::nan("")}), ErrorCode::usage);
  EXPECT_EQ(code({.width = 16, .height = 16}), ErrorCode{0});
}

TEST(Render, StopsWhenAskedTo) {
  int asked = 0;
  Progress progress;
  progress.cancelled = [&] { return ++asked > 3; };
  EXPECT_EQ(codeOf([&] { (void)renderFragments(rowOfBalls(2), {}, &progress); }),
            ErrorCode::cancelled);
}

using Png = TempFolder;

/// Every byte value, in no pattern that a filter likes.
Image noise(int width, int height) {
  Image image{width, height,
              std::vector<std::uint8_t>(static_cast<std::size_t>(3 * width * height))};
  std::uint32_t state = 1;
  for (std::uint8_t& byte : image.rgb)
    byte = static_cast<std::uint8_t>((state = state * 1664525u + 1013904223u) >> 24);
  return image;
}

TEST_F(Png, ReadsBackAsThePictureItWas) {
  for (const Image& image : {noise(97, 41), renderFragments({}, {.width = 64, .height = 48})}) {
    writePng(folder_ / "a.png", image);
    png_image reader{};
    reader.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_file(&reader, (folder_ / "a.png").c_str()));
    EXPECT_EQ(reader.format, static_cast<png_uint_32>(PNG_FORMAT_RGB));
    ASSERT_EQ(static_cast<int>(reader.width), image.width);
    ASSERT_EQ(static_cast<int>(reader.height), image.height);
    std::vector<std::uint8_t> rgb(image.rgb.size());
    ASSERT_TRUE(png_image_finish_read(&reader, nullptr, rgb.data(), 0, nullptr));
    EXPECT_EQ(rgb, image.rgb);
  }
}

TEST_F(Png, HoldsNothingButThePicture) {
  writePng(folder_ / "a.png", noise(97, 41));
  writePng(folder_ / "b.png", noise(97, 41));
  const std::string bytes = bytesOf(folder_ / "a.png");
  EXPECT_EQ(bytes, bytesOf(folder_ / "b.png"));
  std::set<std::string> chunks;
  for (std::size_t i = 8; i + 12 <= bytes.size();) {
    std::size_t length = 0;
    for (std::size_t k = 0; k < 4; ++k)
      length = length << 8 | static_cast<unsigned char>(bytes[i + k]);
    chunks.insert(bytes.substr(i + 4, 4));
    i += 12 + length;
  }
  EXPECT_EQ(chunks, (std::set<std::string>{"IHDR", "sRGB", "IDAT", "IEND"}));
}

TEST_F(Png, RefusesWhereItCannotWrite) {
  EXPECT_EQ(codeOf([&] { writePng(folder_ / "absent" / "a.png", noise(8, 8)); }),
            ErrorCode::output);
  EXPECT_EQ(codeOf([&] { writePng(folder_, noise(8, 8)); }), ErrorCode::output);
  EXPECT_EQ(codeOf([&] { writePng(folder_ / "a.png", {8, 8, {}}); }), ErrorCode::output);
  EXPECT_TRUE(fs::is_empty(folder_));
}

// A limit on the size of this process's files stands for a disk that is full.
TEST_F(Png, LeavesNothingOnAFullDisk) {
  struct rlimit old {};
  ::getrlimit(RLIMIT_FSIZE, &old);
  const auto oldHandler = std::signal(SIGXFSZ, SIG_IGN);
  const struct rlimit small { 1000, old.rlim_max };
  ::setrlimit(RLIMIT_FSIZE, &small);
  const ErrorCode code = codeOf([&] { writePng(folder_ / "a.png", noise(97, 41)); });
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, oldHandler);
  EXPECT_EQ(code, ErrorCode::output);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST(Palette, NeighborsInNumberDiffer) {
  for (int i = 0; i < 40; ++i)
    for (int j = i + 1; j < i + 8; ++j) {
      const glm::vec3 a = fragmentColor(i).outer, b = fragmentColor(j).outer;
      int difference = 0;
      for (int k = 0; k < 3; ++k)
        difference = std::max(difference, std::abs(byteFromLinear(a[k]) - byteFromLinear(b[k])));
      EXPECT_GT(difference, 20) << i << " and " << j;
    }
}

TEST(Palette, BytesAreSrgb) {
  for (int byte = 0; byte < 256; ++byte)
    EXPECT_EQ(byteFromLinear(linearFromSrgb(static_cast<float>(byte) / 255.0f)), byte);
  EXPECT_EQ(byteFromLinear(-1.0f), 0);
  EXPECT_EQ(byteFromLinear(2.0f), 255);
}

}  // namespace
}  // namespace sherd
