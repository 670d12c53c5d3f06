// Memory estimated before it is taken.
#include "base/memory.h"

#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "base/memory_bounds.h"
#include "pipeline/memory_estimate.h"
#include "shapes.h"
#include "temp_folder.h"

namespace sherd {
namespace {

TEST(Memory, GoesByTheSurfaceInVoxelsAndTheVolume) {
  const TriangleMesh ball = shapes::ball(1.0, 6);
  const auto at = [&](int resolution) {
    return static_cast<double>(estimatedMemory(ball, {.solid = {.resolution = resolution}}));
  };
  EXPECT_GT(at(256), at(128));
  const double growth = (at(2048) - at(8)) / (at(1024) - at(8));
  EXPECT_GT(growth, 4.0);  // as the surface
  EXPECT_LT(growth, 8.0);  // as the volume
  EXPECT_GT(estimatedMemory(ball, {.pieces = 500}), estimatedMemory(ball, {.pieces = 2}));
  FractureOptions fewer;  // their mesh is simplified
  fewer.surface.triangles = {1000};
  EXPECT_GT(estimatedMemory(ball, fewer), estimatedMemory(ball, {}));
  EXPECT_LT(estimatedMemory(ball, {}, MeshesHeld::some), estimatedMemory(ball, {}));
  EXPECT_EQ(estimatedMemory(ball, fewer, MeshesHeld::some), estimatedMemory(ball, fewer));
  EXPECT_EQ(estimatedMemory(ball, {}, MeshesHeld::preview), estimatedMemory(ball, {}));
  const FractureOptions large{.solid = {.resolution = 2048}};
  const std::uint64_t previewLarge = estimatedMemory(ball, large, MeshesHeld::preview);
  EXPECT_LT(previewLarge, estimatedMemory(ball, large));
  EXPECT_GT(previewLarge, estimatedMemory(ball, large, MeshesHeld::some));
  FractureOptions chain, eroded, cost;  // numbers for each voxel
  chain.grow.growth = Growth::chain;
  eroded.erode.iterations = 1;
  cost.grow.keepCost = true;
  for (const FractureOptions& more : {chain, eroded, cost}) {
    EXPECT_GT(estimatedMemory(ball, more), estimatedMemory(ball, {}));
  }
  // A part that is inside out takes no less.
  const TriangleMesh two = shapes::append(ball, shapes::cube(1.0, {5.0, 0.0, 0.0}));
  const TriangleMesh turned =
      shapes::append(ball, shapes::inverted(shapes::cube(1.0, {5.0, 0.0, 0.0})));
  EXPECT_EQ(estimatedMemory(two, {}), estimatedMemory(turned, {}));
}

// Cracks in thin walls need the way to the middle for each voxel: three numbers of two bytes.
TEST(Memory, CracksInThinWallsTakeMore) {
  const auto bytes = [](const TriangleMesh& mesh, SeedsOn on, Growth growth) {
    FractureOptions options{.solid = {.resolution = 256}};
    options.pieces = 12;
    options.seeds.on = on;
    options.grow.growth = growth;
    return static_cast<double>(estimatedMemory(mesh, options));
  };
  const TriangleMesh cube = shapes::cube(1.0);
  TriangleMesh plate = cube;
  for (auto& vertex : plate.vertices) vertex.z *= 0.05;
  const double none = bytes(plate, SeedsOn::volume, Growth::sequential),
               wall = bytes(plate, SeedsOn::wall, Growth::sequential);
  const double inside = 0.05 * std::pow(256.0, 3.0);
  EXPECT_GT(wall - none, 6.0 * inside);
  EXPECT_EQ(bytes(plate, SeedsOn::automatic, Growth::sequential), wall);
  EXPECT_EQ(bytes(plate, SeedsOn::surface, Growth::sequential), none);
  EXPECT_DOUBLE_EQ(
      bytes(plate, SeedsOn::wall, Growth::euclid) - bytes(plate, SeedsOn::volume, Growth::euclid),
      wall - none);
  EXPECT_EQ(bytes(plate, SeedsOn::wall, Growth::flood),
            bytes(plate, SeedsOn::volume, Growth::flood));
  EXPECT_EQ(bytes(cube, SeedsOn::automatic, Growth::sequential),
            bytes(cube, SeedsOn::volume, Growth::sequential));
}

// Guides take their surfaces, which do not depend on the resolution, and a bit for each voxel.
TEST(Memory, GuidesTakeMore) {
  const TriangleMesh ball = shapes::ball(1.0, 4);
  const auto bytes = [&](const std::vector<Guide>& guides, int resolution) {
    return static_cast<double>(
        estimatedMemory(ball, {.solid = {.resolution = resolution}, .guides = guides}));
  };
  const TriangleMesh fine = shapes::ball(0.5, 6);
  const double triangles = static_cast<double>(fine.triangles.size());
  for (const int resolution : {64, 256}) {
    const double none = bytes({}, resolution), one = bytes({{.mesh = fine}}, resolution),
                 two = bytes({{.mesh = fine}, {.mesh = fine}}, resolution);
    EXPECT_NEAR(two - one, one - none, 2.0);
    // A sphere takes no less than its vertices and triangles twice, and the bits of inside voxels.
    const double inside = 0.5 * std::pow(resolution, 3.0);
    EXPECT_GT(one - none, 2.0 * (12.0 + 12.0) * triangles + inside / 8.0);
    EXPECT_LT(one - none, 1000.0 * triangles + inside);
  }
  const std::vector<std::vector<glm::dvec3>> line{{{1, 0, 0}, {0, 1, 0}}};
  EXPECT_GT(bytes({{.polylines = line}}, 64), bytes({}, 64));
  FractureOptions many;
  many.guides.assign(200, {.mesh = fine});
  EXPECT_NO_THROW(requireMemory(ball, {.solid = {.resolution = 64}}, 800'000'000));
  many.solid.resolution = 64;
  EXPECT_THROW(requireMemory(ball, many, 800'000'000), Error);
}

// What a ball's shell is made of is known: between two balls, the inner of which may be gone.
TEST(Memory, AShellTakesMoreTheThickerItIs) {
  const double radius = 1.0;
  const TriangleMesh ball = shapes::ball(radius);
  std::uint64_t before = 0;
  for (const double thickness : {0.05, 0.2, 0.5, 1.0, 2.0}) {
    for (const Fill fill : {Fill::shell, Fill::automatic}) {
      const FractureOptions options{
          .pieces = 1, .solid = {.resolution = 256, .fill = fill, .shellThickness = thickness}};
      const double outer = radius + thickness / 2, inner = std::max(radius - thickness / 2, 0.0);
      const double voxels = 128.0 / radius;  // along a unit
      const auto held = static_cast<double>(estimatedMemory(ball, options));
      const auto least = static_cast<double>(estimatedMemory(
          shapes::hollowBallArea(outer, inner) * voxels * voxels,
          (shapes::ballVolume(outer) - shapes::ballVolume(inner)) * voxels * voxels * voxels));
      EXPECT_GE(held, 0.95 * least) << thickness;  // the mesh is a little smaller than the ball
      EXPECT_LE(held, 1.6 * least) << thickness;
    }
    const std::uint64_t now =
        estimatedMemory(ball, {.solid = {.resolution = 256, .shellThickness = thickness}});
    EXPECT_GT(now, before);
    before = now;
  }
  EXPECT_THROW(
      requireMemory(ball, {.solid = {.resolution = 256, .shellThickness = 2.0}}, 600'000'000),
      Error);
  EXPECT_THROW(requireMemory(ball, {.solid = {.shellThickness = 1e9}}, ~std::uint64_t{0}), Error);
}

TEST(Memory, ARefusalNamesTheResolutionThatFits) {
  const TriangleMesh ball = shapes::ball(1.0, 6);
  const std::uint64_t limit = 1'000'000'000;
  EXPECT_NO_THROW(requireMemory(ball, {.solid = {.resolution = 128}}, limit));
  try {
    requireMemory(ball, {.solid = {.resolution = 4096}}, limit);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::usage);
    const std::string sentence = e.what(), before = "a resolution of ";
    EXPECT_EQ(e.options(), (OptionNames{"resolution", "max-memory"}));
    const std::size_t at = sentence.find(before);
    ASSERT_NE(at, std::string::npos) << sentence;
    const int fits = std::stoi(sentence.substr(at + before.size()));
    EXPECT_LE(estimatedMemory(ball, {.solid = {.resolution = fits}}), limit);
    EXPECT_GT(estimatedMemory(ball, {.solid = {.resolution = fits + 1}}), limit);
  }
  const std::uint64_t all = estimatedMemory(ball, {.solid = {.resolution = 1024}}),
                      some =
                          estimatedMemory(ball, {.solid = {.resolution = 1024}}, MeshesHeld::some);
  EXPECT_NO_THROW(requireMemory(ball, {.solid = {.resolution = 1024}}, some, MeshesHeld::some));
  for (const std::uint64_t tight : {(all + some) / 2, some - 1}) {
    try {
      requireMemory(ball, {.solid = {.resolution = 1024}}, tight);
      FAIL();
    } catch (const Error& e) {
      const std::string message = e.what();
      const bool suggestsSome = message.find("without the preview image") != std::string::npos;
      EXPECT_EQ(suggestsSome, tight >= some) << message;
      EXPECT_EQ(e.options().size(), suggestsSome ? 3u : 2u) << message;
    }
  }
  try {
    requireMemory(ball, {}, 1000);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("no resolution fits"), std::string::npos) << e.what();
  }
}

// The root folder of a system with cgroups.
class Cgroups : public TempFolder {
 protected:
  void write(const std::string& file, const std::string& text) {
    const std::filesystem::path path = folder_ / file;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text << "\n";
  }
  void group1(const std::string& group, const std::string& limit, const std::string& used,
              const std::string& cached) {
    const std::string folder = "sys/fs/cgroup/memory" + group + "/memory.";
    write(folder + "limit_in_bytes", limit);
    write(folder + "usage_in_bytes", used);
    write(folder + "stat", "cache 99\ninactive_file 7\ntotal_inactive_file " + cached);
  }
  double left() const { return leftByGroups(folder_); }

  static constexpr const char* kUnlimited = "9223372036854771712";
};

TEST_F(Cgroups, Version1LimitsAsVersion2) {
  EXPECT_EQ(left(), std::numeric_limits<double>::infinity());
  write("proc/self/cgroup",
        "12:pids:/a\n9:cpu,memory:/a/b\n3:memory_of_others:/c\n1:name=systemd:/");
  group1("/a/b", "1000", "300", "20");
  EXPECT_EQ(left(), 720.0);
  group1("/a", "900", "400", "5");  // the group that it is in leaves less
  EXPECT_EQ(left(), 505.0);
  group1("", kUnlimited, "5000", "0");
  EXPECT_EQ(left(), 505.0);
  group1("", "600", "500", "0");
  EXPECT_EQ(left(), 100.0);
  group1("/a", "900", "1000", "5");  // more than is allowed
  EXPECT_EQ(left(), 0.0);
}

TEST_F(Cgroups, Version1WithoutALimitLeavesAll) {
  write("proc/self/cgroup", "9:memory:/a");
  group1("/a", kUnlimited, "300", "20");
  group1("", kUnlimited, "300", "20");
  EXPECT_EQ(left(), std::numeric_limits<double>::infinity());
}

// In a container the path is the host's, and the container's own group is the root.
TEST_F(Cgroups, Version1OfAContainerIsItsRoot) {
  write("proc/self/cgroup", "9:memory:/docker/0123");
  group1("", "1000", "100", "0");
  EXPECT_EQ(left(), 900.0);
}

TEST_F(Cgroups, LimitsWithoutOtherFilesCount) {
  write("proc/self/cgroup", "9:memory:/a\n0::/b");
  write("sys/fs/cgroup/memory/a/memory.limit_in_bytes", "1000");
  EXPECT_EQ(left(), 1000.0);
  write("sys/fs/cgroup/b/memory.max", "500");
  EXPECT_EQ(left(), 500.0);
}

TEST_F(Cgroups, Version2LimitsByEachOfTheNestedGroups) {
  write("proc/self/cgroup", "0::/a/b");
  write("sys/fs/cgroup/a/b/memory.max", "max");
  EXPECT_EQ(left(), std::numeric_limits<double>::infinity());
  write("sys/fs/cgroup/a/memory.max", "1000");
  write("sys/fs/cgroup/a/memory.current", "300");
  write("sys/fs/cgroup/a/memory.stat", "anon 5\ninactive_file 50");
  EXPECT_EQ(left(), 750.0);
}

TEST(Memory, SomeIsFree) { EXPECT_GT(freeMemory(), std::uint64_t{1} << 20); }

}  // namespace
}  // namespace sherd
