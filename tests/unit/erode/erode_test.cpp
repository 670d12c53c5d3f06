// Erosion against a plain reference, OpenVDB's own erosion, and what it promises.
#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/labels.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <set>

#include "kernels/device_fixture.h"
#include "kernels/voxel_shapes.h"
#include "unit/erode/erode_reference.h"

namespace sherd {
namespace {

using erode_reference::Labeled;
using openvdb::Coord;
using voxel_shapes::VoxelSolid;

Labeled oneFragment(const VoxelSolid& solid) {
  return erode_reference::labeled(solid, 1, [](const Coord&) { return 1; });
}

Labeled twoHalves(const VoxelSolid& solid) {
  return erode_reference::labeled(solid, 2, [](const Coord& v) { return v.x() < 0 ? 1 : 2; });
}

class Erode : public DeviceTest {
 protected:
  static Erosion eroded(const Labeled& solid, const ErodeOptions& options) {
    return erode(solid.labels, options, device());
  }

  static std::set<Coord> erodedBy(const Labeled& solid, const ErodeOptions& options) {
    const Labels labels = eroded(solid, options).labels;
    std::set<Coord> eroded;
    for (const auto& [voxel, label] : solid.voxels) {
      if (labels.fragment[voxel_shapes::voxelIndexOf(*solid.labels.blocks, voxel)] ==
          Labels::kEroded) {
        eroded.insert(voxel);
      }
    }
    return eroded;
  }

  static void expectAsReference(const Labeled& solid, const ErodeOptions& options) {
    const std::map<Coord, int> expected = erode_reference::erode(solid, options);
    const Erosion result = eroded(solid, options);
    std::size_t differ = 0;
    std::vector<std::uint64_t> eroded(static_cast<std::size_t>(solid.labels.fragmentCount) + 1);
    Labels labels = solid.labels;
    for (const auto& [voxel, label] : expected) {
      const std::size_t voxelIndex = voxel_shapes::voxelIndexOf(*solid.labels.blocks, voxel);
      differ += result.labels.fragment[voxelIndex] != label;
      if (label != solid.voxels.at(voxel))
        ++eroded[static_cast<std::size_t>(solid.voxels.at(voxel))];
      labels.fragment[voxelIndex] = static_cast<std::uint16_t>(label);
    }
    for (std::size_t i = 1; i < eroded.size(); ++i) eroded[0] += eroded[i];
    EXPECT_EQ(differ, 0u);
    EXPECT_EQ(result.labels.fragment, labels.fragment) << "outside the solid";
    EXPECT_EQ(result.eroded, eroded);
  }
};

TEST_F(Erode, EqualsTheReferenceForEveryShape) {
  for (const Labeled& solid : erode_reference::all()) {
    for (const auto shape : {ErodeShape::cross, ErodeShape::square, ErodeShape::ellipse}) {
      for (int size = 3; size <= 13; size += 2) {
        for (const bool planes : {false, true}) {
          for (const auto on : {ErodeOn::fracture, ErodeOn::all, ErodeOn::rims}) {
            for (const double threshold : {1.0, 0.6}) {
              SCOPED_TRACE(testing::Message()
                           << solid.name << ", shape " << static_cast<int>(shape) << " of " << size
                           << (planes ? " in planes" : "") << ", threshold " << threshold << ", on "
                           << static_cast<int>(on));
              expectAsReference(solid, {.shape = shape,
                                        .size = size,
                                        .planes = planes,
                                        .iterations = 2,
                                        .threshold = threshold,
                                        .on = on,
                                        .islands = size == 3 ? Islands::eroded : Islands::kept});
              if (HasFailure()) return;
            }
          }
        }
      }
    }
  }
}

TEST_F(Erode, EqualsOpenVdbsErosion) {
  for (const Labeled& solid : erode_reference::all()) {
    for (const bool cube : {false, true}) {
      SCOPED_TRACE(solid.name + (cube ? ", 26 neighbors" : ", 6 neighbors"));
      const ErodeOptions options{.shape = cube ? ErodeShape::square : ErodeShape::cross,
                                 .iterations = 1,
                                 .on = ErodeOn::all,
                                 .islands = Islands::kept};
      const std::set<Coord> eroded = erodedBy(solid, options);
      for (int id = 1; id <= solid.labels.fragmentCount; ++id) {
        const std::set<Coord> left = erode_reference::erodedByOpenVdb(solid, id, cube);
        for (const auto& [voxel, label] : solid.voxels) {
          // Where OpenVDB leaves nothing, we leave the fragment.
          if (label != id) continue;
          EXPECT_EQ(eroded.count(voxel), !left.empty() && !left.count(voxel));
        }
      }
    }
  }
}

// How far a count of n fair coins may lie from n / 2: 5 standard deviations, passed by chance less
// than once in a million.
double fairBound(std::size_t n) { return 5 * std::sqrt(static_cast<double>(n)) / 2; }

TEST_F(Erode, AProbabilityOfOneHalfWearsHalf) {
  const Labeled solid = twoHalves(voxel_shapes::ball(16));
  ErodeOptions options{.iterations = 1, .on = ErodeOn::all, .islands = Islands::kept};
  const std::set<Coord> certain = erodedBy(solid, options);
  options.probability = 0.5;
  const std::set<Coord> once = erodedBy(solid, options);
  ASSERT_GT(certain.size(), 1000u);
  for (const Coord& voxel : once) EXPECT_TRUE(certain.count(voxel));
  EXPECT_NEAR(static_cast<double>(once.size()), static_cast<double>(certain.size()) / 2,
              fairBound(certain.size()));

  // Each iteration draws anew: half of those that were spared go in the second.
  options.iterations = 2;
  const std::set<Coord> twice = erodedBy(solid, options);
  std::size_t spared = 0, later = 0;
  for (const Coord& voxel : certain) {
    spared += once.count(voxel) == 0;
    later += once.count(voxel) == 0 && twice.count(voxel) != 0;
  }
  EXPECT_NEAR(static_cast<double>(later), static_cast<double>(spared) / 2, fairBound(spared));

  // Another seed agrees with this one on half.
  options.iterations = 1;
  options.seed = 1;
  const std::set<Coord> other = erodedBy(solid, options);
  std::size_t agree = 0;
  for (const Coord& voxel : certain) agree += once.count(voxel) == other.count(voxel);
  EXPECT_NEAR(static_cast<double>(agree), static_cast<double>(certain.size()) / 2,
              fairBound(certain.size()));
}

TEST_F(Erode, DrawsDoNotDependOnThreadsOrOnWhatElseIsThere) {
  const ErodeOptions options{.iterations = 3, .probability = 0.4, .on = ErodeOn::all, .seed = 9};
  const Labeled large = oneFragment(voxel_shapes::ball(28));  // hundreds of leaves
  const std::set<Coord> eroded = erodedBy(large, options);
  EXPECT_GT(eroded.size(), 1000u);
  for (const std::size_t threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_EQ(erodedBy(large, options), eroded);
  }
  VoxelSolid solid = voxel_shapes::ball(12);
  const std::set<Coord> alone = erodedBy(twoHalves(solid), options);
  // More leaves before and after, a third fragment, other ids.
  for (int i = 0; i < 40; ++i) {
    solid.inside.insert({i, -30, 0});
    solid.inside.insert({-30, i, 5});
  }
  const auto three = [](const Coord& v) {
    return v.x() == -30 || v.y() == -30 ? 1 : v.x() < 0 ? 3 : 2;
  };
  std::set<Coord> among = erodedBy(erode_reference::labeled(solid, 3, three), options);
  std::erase_if(among, [&](const Coord& v) { return three(v) == 1; });
  EXPECT_EQ(among, alone);
}

TEST_F(Erode, LeavesTheOriginalSurfaceWhereThereIsNoCrack) {
  const Labeled whole = oneFragment(voxel_shapes::ball(10));
  EXPECT_EQ(eroded(whole, {.iterations = 5}).eroded[0], 0u);
  // Two halves lose a layer on either side of the cut, x = -1 and x = 0, and a further one in each
  // iteration.
  const Labeled halves = twoHalves(voxel_shapes::ball(10));
  for (const int iterations : {1, 3}) {
    const std::set<Coord> eroded = erodedBy(halves, {.iterations = iterations});
    for (const auto& [voxel, label] : halves.voxels) {
      EXPECT_EQ(eroded.count(voxel), voxel.x() >= -iterations && voxel.x() < iterations);
    }
  }
}

TEST_F(Erode, NeverWearsAFragmentAway) {
  // Single voxels, and a solid that iterations would eat up.
  VoxelSolid line{"line", {}, {}};
  for (int i = -9; i < 9; ++i) line.inside.insert({i, 0, 0});
  const Labeled single =
      erode_reference::labeled(line, 18, [](const Coord& v) { return v.x() + 10; });
  EXPECT_EQ(eroded(single, {.iterations = 9, .on = ErodeOn::all}).eroded[0], 0u);
  const Labeled ball = oneFragment(voxel_shapes::ball(9));
  for (const double probability : {1.0, 0.3}) {
    const Erosion result = eroded(
        ball, {.iterations = 100, .probability = probability, .on = ErodeOn::all, .seed = 3});
    EXPECT_GT(result.eroded[0], 0u);
    EXPECT_LT(result.eroded[0], ball.voxels.size());
  }
}

TEST_F(Erode, OfAFragmentThatFallsApartTheLargestComponentStays) {
  // Two cubes of 7 and 6 voxels on a bar 2 thick, which one iteration takes.
  const VoxelSolid dumbbell = voxel_shapes::solidWhere("dumbbell", 12, [](const Coord& v) {
    const auto within = [](int c, int low, int high) { return c >= low && c <= high; };
    const auto cube = [&](int low, int high) {
      return within(v.x(), low, high) && within(v.y(), -3, high - low - 3) &&
             within(v.z(), -3, high - low - 3);
    };
    return cube(-10, -4) || cube(5, 10) ||
           (within(v.x(), -4, 5) && v.y() >> 1 == 0 && v.z() >> 1 == 0);
  });
  const Labeled solid = oneFragment(dumbbell);
  ErodeOptions options{.shape = ErodeShape::square, .iterations = 1, .on = ErodeOn::all};
  const std::size_t voxels = solid.voxels.size();
  EXPECT_EQ(eroded(solid, options).eroded,
            (std::vector<std::uint64_t>{voxels - 125, voxels - 125}));
  for (const Coord& voxel : erodedBy(solid, options)) {
    EXPECT_FALSE(voxel.x() >= -9 && voxel.x() <= -5 && std::abs(voxel.y()) <= 2 &&
                 std::abs(voxel.z()) <= 2);
  }
  options.islands = Islands::kept;
  EXPECT_EQ(eroded(solid, options).eroded[1], voxels - 125 - 64);
}

TEST_F(Erode, OfEqualComponentsTheFirstInLeafOrderStays) {
  // The parts begin in one leaf, (0, 9, 0) comes before (1, 0, 0) by x, but its leaf comes later.
  VoxelSolid two{"two", {{1, 0, 0}, {2, 0, 0}, {0, 9, 0}, {0, 10, 0}}, {}};
  const std::set<Coord> eroded = erodedBy(oneFragment(two), {.iterations = 1});
  EXPECT_EQ(eroded, (std::set<Coord>{{0, 9, 0}, {0, 10, 0}}));
}

TEST_F(Erode, CountsOnlyWhatItWore) {
  // A second erosion goes on where the first ended, and leaves what it wore.
  Labeled solid = twoHalves(voxel_shapes::ball(8));
  const Erosion first = eroded(solid, {.iterations = 1});
  EXPECT_EQ(first.eroded[0], first.eroded[1] + first.eroded[2]);
  solid.labels = first.labels;
  const Erosion second = eroded(solid, {.iterations = 2});
  const Erosion both = eroded(twoHalves(voxel_shapes::ball(8)), {.iterations = 3});
  EXPECT_EQ(second.labels.fragment, both.labels.fragment);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(first.eroded[i] + second.eroded[i], both.eroded[i]);
}

TEST_F(Erode, WithoutIterationsChangesNothing) {
  const Labeled solid = erode_reference::all().back();
  const Erosion result = eroded(solid, {});
  EXPECT_EQ(result.labels.fragment, solid.labels.fragment);
  EXPECT_EQ(result.eroded, std::vector<std::uint64_t>(4));
}

TEST_F(Erode, RefusesWhatCannotBe) {
  const Labeled solid = oneFragment(voxel_shapes::ball(3));
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (const ErodeOptions& options : std::vector<ErodeOptions>{{.size = 1},
                                                               {.size = 4},
                                                               {.size = 15},
                                                               {.iterations = -1},
                                                               {.iterations = 1001},
                                                               {.threshold = 0},
                                                               {.threshold = 1.1},
                                                               {.threshold = none},
                                                               {.probability = 0},
                                                               {.probability = 1.01},
                                                               {.probability = none}}) {
    EXPECT_THROW((void)eroded(solid, options), Error);
  }
  const auto refuses = [](const Labeled& wrong) {
    EXPECT_THROW((void)eroded(wrong, {.iterations = 1}), Error);
  };
  Labeled wrong = solid;
  wrong.labels.fragmentCount = 0;
  refuses(wrong);
  wrong.labels.fragmentCount = 65535;
  refuses(wrong);
  wrong = solid;
  wrong.labels.fragment.pop_back();
  refuses(wrong);
  wrong = solid;
  wrong.labels.fragment[voxel_shapes::voxelIndexOf(*solid.labels.blocks, {0, 0, 0})] = 2;
  refuses(wrong);
}

TEST_F(Erode, StopsWhenAsked) {
  const Labeled solid = twoHalves(voxel_shapes::ball(6));
  int asked = 0;
  std::vector<double> reported;
  const Progress progress{.report = [&](auto, double fraction) { reported.push_back(fraction); },
                          .cancelled = [&] { return ++asked == 3; }};
  try {
    (void)erode(solid.labels, {.iterations = 4}, device(), &progress);
    FAIL() << "nothing was thrown";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::cancelled);
  }
  EXPECT_EQ(reported, (std::vector<double>{0.0, 0.25}));
}

}  // namespace
}  // namespace sherd
