// Impacts with an energy: radial cracks and rings on plates and shells, and where there are none.
#include "seed/impact_rings.h"

#include <gtest/gtest.h>
#include <sherd/error.h>
#include <sherd/labels.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <set>

#include "kernels/device_fixture.h"
#include "kernels/grow_reference.h"
#include "kernels/voxel_shapes.h"
#include "pipeline/fracture_stages.h"
#include "shapes.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

class ImpactRings : public DeviceTest {
 protected:
  static PreparedSolid solidOf(const TriangleMesh& mesh, int resolution) {
    return prepared(voxelize(mesh, {.resolution = resolution}), device());
  }
};

// A plate in x and y about the origin, of side 2.
TriangleMesh plate(double thickness = 0.05) { return shapes::box({2.0, 2.0, thickness}); }

std::vector<Seed> ringSeeds(const PreparedSolid& on, const std::vector<Impact>& impacts, int pieces,
                            std::uint64_t seed = 3) {
  return placeSeeds(on.solid, on.components, {.pieces = pieces, .seed = seed, .impacts = impacts});
}

Labels grownFrom(const PreparedSolid& on, const std::vector<Seed>& seeds, Device& device) {
  return std::move(grow(on.solid.blocks, std::span(&seeds, 1), device).front());
}

std::uint16_t labelAt(const PreparedSolid& on, const Labels& labels, const glm::dvec3& world) {
  const glm::dvec3 at = on.solid.frame.indexFromWorld(world);
  const openvdb::Coord voxel(static_cast<int>(std::lround(at.x)),
                             static_cast<int>(std::lround(at.y)),
                             static_cast<int>(std::lround(at.z)));
  const std::uint32_t leaf = findLeaf(*on.solid.blocks, voxel);
  if (leaf == LeafBlocks::kNone) return 0;
  return labels.fragment[std::size_t{leaf} * 512 + offsetFromCoord(voxel)];
}

// Changes of label along a circle about the origin.
int cracksOver(const PreparedSolid& on, const Labels& labels, double radius) {
  constexpr int kSteps = 2000;
  int changes = 0;
  std::uint16_t before = labelAt(on, labels, {radius, 0.0, 0.0});
  for (int i = 1; i <= kSteps; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSteps;
    const std::uint16_t own =
        labelAt(on, labels, {radius * std::cos(angle), radius * std::sin(angle), 0.0});
    changes += own != before;
    before = own;
  }
  return changes;
}

// Other fragments on the way outwards, the median over directions: a way beside a radial crack
// meets those of two sectors.
int ringsAlong(const PreparedSolid& on, const Labels& labels, double from, double to) {
  constexpr int kWays = 65, kSteps = 500;
  std::vector<int> counts;
  for (int way = 0; way < kWays; ++way) {
    const double angle = 2.0 * std::numbers::pi * way / kWays;
    std::set<std::uint16_t> met;
    for (int i = 0; i <= kSteps; ++i) {
      const double r = from + (to - from) * i / kSteps;
      met.insert(labelAt(on, labels, {r * std::cos(angle), r * std::sin(angle), 0.0}));
    }
    counts.push_back(static_cast<int>(met.size()) - 1);
  }
  std::sort(counts.begin(), counts.end());
  return counts[kWays / 2];
}

TEST_F(ImpactRings, PatternGrowsByTheEnergy) {
  RingPattern before = ringPatternFor(0.01, 100.0, 0.0);
  EXPECT_EQ(before.radials, 3);
  for (const double energy : {0.1, 1.0, 10.0, 100.0}) {
    const RingPattern pattern = ringPatternFor(energy, 100.0, 0.0);
    EXPECT_GT(pattern.radials, before.radials);
    EXPECT_GE(pattern.rings, before.rings);
    EXPECT_GT(pattern.radius, before.radius);
    EXPECT_LT(pattern.radius, 50.0);
    // A ring crack half way between two rows, the last one at the radius.
    EXPECT_NEAR(0.5 * (pattern.rowRadius(pattern.rings - 1) + pattern.rowRadius(pattern.rings)),
                pattern.radius, 1e-9);
    before = pattern;
  }
  // Sixteen times the energy is four times the speed: twice the radial cracks.
  EXPECT_EQ(ringPatternFor(16.0, 100.0, 0.0).radials, 2 * ringPatternFor(1.0, 100.0, 0.0).radials);
}

// On a circle within the innermost ring crack there are the radial cracks and no others.
TEST_F(ImpactRings, RadialCracksCrossASmallCircle) {
  const PreparedSolid on = solidOf(plate(), 200);
  for (const double energy : {0.1, 1.0, 16.0}) {
    const RingPattern pattern = ringPatternFor(energy, 2.0, 0.0);
    const int pieces = static_cast<int>(pattern.seeds()) + 1;
    const Impact impact{.target = glm::dvec3(0.0, 0.0, 0.025), .energy = energy};
    const Labels labels = grownFrom(on, ringSeeds(on, {impact}, pieces), device());
    EXPECT_EQ(labels.fragmentCount, pieces);
    EXPECT_EQ(reference::countConnectedComponents(reference::mapOf(labels)),
              static_cast<std::size_t>(pieces));
    // The component's own seed, anywhere, may add a piece there.
    const int cracks = cracksOver(on, labels, 0.9 * pattern.rowRadius(0));
    EXPECT_GE(cracks, pattern.radials) << energy;
    EXPECT_LE(cracks, pattern.radials + 2) << energy;
  }
}

TEST_F(ImpactRings, RingsAreCrossedOnTheWayOutwards) {
  const PreparedSolid on = solidOf(plate(), 200);
  for (const double energy : {0.1, 1.0, 16.0}) {
    const RingPattern pattern = ringPatternFor(energy, 2.0, 0.0);
    const Impact impact{.target = glm::dvec3(0.0, 0.0, 0.025), .energy = energy};
    const Labels labels =
        grownFrom(on, ringSeeds(on, {impact}, static_cast<int>(pattern.seeds()) + 1), device());
    EXPECT_EQ(ringsAlong(on, labels, pattern.rowRadius(0), pattern.rowRadius(pattern.rings)),
              pattern.rings)
        << energy;
  }
}

// Pieces by area in annuli of doubling radius.
TEST_F(ImpactRings, DensityFallsWithTheDistance) {
  const PreparedSolid on = solidOf(plate(), 160);
  for (const int pieces : {40, 80}) {
    const Impact impact{.target = glm::dvec3(0.0, 0.0, 0.025), .energy = 2.0};
    const std::vector<Seed> seeds = ringSeeds(on, {impact}, pieces);
    double before = std::numeric_limits<double>::infinity();
    for (double from = 0.0, to = 0.125; to <= 1.0; from = to, to *= 2.0) {
      int inside = 0;
      for (const Seed& seed : seeds) {
        const glm::dvec3 at = on.solid.frame.worldFromIndex(pointOf(seed));
        const double r = std::hypot(at.x, at.y);
        inside += r >= from && r < to;
      }
      const double density = inside / (std::numbers::pi * (to * to - from * from));
      EXPECT_LT(density, before) << to;
      before = density;
    }
  }
}

TEST_F(ImpactRings, LieInTheMiddleOfTheWall) {
  const PreparedSolid on = solidOf(plate(), 128);
  const Impact impact{.target = glm::dvec3(0.3, 0.1, 1.0), .count = 30, .energy = 2.0};
  int inMiddle = 0;
  for (const Seed& seed : ringSeeds(on, {impact}, 31)) {
    const glm::dvec3 at = on.solid.frame.worldFromIndex(pointOf(seed));
    inMiddle += std::abs(at.z) < 0.02 * 0.05;
  }
  EXPECT_GE(inMiddle, 30);
}

// Along a sphere of radius r a circle of arc length s has the radius r sin(s / r).
TEST_F(ImpactRings, MeasureArcLengthOnAShell) {
  const double outer = 1.0, inner = 0.94, middle = 0.97;
  const PreparedSolid on = solidOf(shapes::hollowBall(outer, inner), 128);
  const RingPattern pattern = ringPatternFor(4.0, 2.0, 0.0);
  const Impact impact{.target = glm::dvec3(0.0, 0.0, 2.0),
                      .count = static_cast<int>(pattern.seeds()),
                      .energy = 4.0};
  const std::vector<Seed> seeds = ringSeeds(on, {impact}, static_cast<int>(pattern.seeds()) + 1);
  std::vector<int> inRow(static_cast<std::size_t>(pattern.rings) + 1, 0);
  for (const Seed& seed : seeds) {
    const glm::dvec3 at = on.solid.frame.worldFromIndex(pointOf(seed));
    const double r = glm::length(at);
    if (std::abs(r - middle) > 0.01) continue;
    const double arc = outer * std::acos(at.z / r);
    for (int row = 0; row <= pattern.rings; ++row) {
      // Rows are jittered by 0.15 of their spacing.
      const double own = pattern.rowRadius(row);
      const double tolerance = 0.16 * own * (1.0 - 1.0 / pattern.ratio) + 0.01;
      inRow[static_cast<std::size_t>(row)] += std::abs(arc - own) < tolerance;
    }
  }
  for (const int count : inRow) {
    EXPECT_GE(count, pattern.radials);
    EXPECT_LE(count, pattern.radials + 1);
  }
}

TEST_F(ImpactRings, KeepTheCountExactly) {
  const PreparedSolid on = solidOf(plate(), 64);
  for (const int count : {1, 2, 7, 20, 60, 150}) {
    for (const bool merge : {false, true}) {
      const Impact impact{
          .target = glm::dvec3(0.9, 0.9, 0.025), .count = count, .energy = 1.0, .merge = merge};
      const std::vector<Seed> seeds = ringSeeds(on, {impact}, 160);
      EXPECT_EQ(fragmentsOf(seeds), 160);
      EXPECT_EQ(seeds.size(), 160u + (merge ? static_cast<std::size_t>(count) : 0u));
      std::set<openvdb::Coord> voxels;
      for (const Seed& seed : seeds) voxels.insert(seed.voxel);
      EXPECT_EQ(voxels.size(), seeds.size());
    }
  }
}

// The pattern stays in the component that is struck, and with few pieces it is cut short.
TEST_F(ImpactRings, StayInTheirComponentAndWithinThePieces) {
  const PreparedSolid on =
      solidOf(shapes::append(plate(), shapes::transformed(plate(), 1.0, {0.0, 0.0, 0.3})), 96);
  ASSERT_EQ(on.components.count(), 2u);
  const Impact impact{.target = glm::dvec3(0.0, 0.0, 0.325), .energy = 1.0};
  int above = 0;
  for (const Seed& seed : ringSeeds(on, {impact}, 34)) {
    above += on.solid.frame.worldFromIndex(pointOf(seed)).z > 0.15;
  }
  EXPECT_GE(above, 32);
  EXPECT_LE(above, 33);
  EXPECT_EQ(fragmentsOf(ringSeeds(on, {impact}, 3)), 3);
  EXPECT_EQ(fragmentsOf(ringSeeds(on, {impact, impact, impact}, 20)), 20);
}

// A ball is thick: seeds are scattered about the point, most within two standard deviations.
TEST_F(ImpactRings, AreScatteredWhereTheSolidIsThick) {
  const PreparedSolid on = solidOf(shapes::ball(1.0), 64);
  const RingPattern pattern = ringPatternFor(1.0, 2.0, 0.0);
  const Impact impact{.target = glm::dvec3(0.0, 0.0, 2.0), .energy = 1.0};
  const std::vector<Seed> seeds = ringSeeds(on, {impact}, 200);
  EXPECT_EQ(fragmentsOf(seeds), 200);
  const auto near = std::count_if(seeds.begin(), seeds.end(), [&](const Seed& seed) {
    const glm::dvec3 at = on.solid.frame.worldFromIndex(pointOf(seed));
    return glm::length(at - glm::dvec3(0.0, 0.0, 1.0)) < pattern.radius;
  });
  EXPECT_GE(near, static_cast<long>(pattern.seeds() / 2));
}

// An open sheet, of which the voxels are a shell: its seeds lie on the sheet.
TEST_F(ImpactRings, BreakAShellOfVoxels) {
  TriangleMesh sheet;
  sheet.vertices = {{-1, -1, 0.1}, {1, -1, -0.1}, {1, 1, 0.1}, {-1, 1, 0.3}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const PreparedSolid on = solidOf(sheet, 128);
  const RingPattern pattern = ringPatternFor(1.0, 2.0, 0.0);
  const Impact impact{.target = glm::dvec3(0.0, 0.0, 0.1), .energy = 1.0};
  std::vector<double> near;
  for (const Seed& seed : ringSeeds(on, {impact}, static_cast<int>(pattern.seeds()) + 1)) {
    near.push_back(
        glm::length(on.solid.frame.worldFromIndex(pointOf(seed)) - glm::dvec3(0.0, 0.0, 0.1)));
  }
  std::sort(near.begin(), near.end());
  // The innermost row and the next: moved by 0.15 of their spacing, and half a voxel.
  const auto radials = static_cast<std::size_t>(pattern.radials);
  const double tolerance = 0.16 * (1.0 - 1.0 / pattern.ratio);
  EXPECT_NEAR(near[radials / 2] / pattern.rowRadius(0), 1.0, tolerance + 0.1);
  EXPECT_NEAR(near[radials + radials / 2] / pattern.rowRadius(1), 1.0, tolerance + 0.05);
}

TEST_F(ImpactRings, RefuseEnergiesOutOfRange) {
  const PreparedSolid on = solidOf(plate(), 32);
  for (const double energy : {-1.0, 0.001, 101.0, std::nan(""), HUGE_VAL}) {
    const Impact impact{.target = glm::dvec3(0.0), .energy = energy};
    EXPECT_THROW((void)ringSeeds(on, {impact}, 10), Error) << energy;
  }
}

TEST_F(ImpactRings, GrowOnTheCoarsestPlate) {
  const PreparedSolid on = solidOf(plate(0.2), 16);
  const Impact impact{.target = glm::dvec3(0.0), .energy = 100.0};
  EXPECT_EQ(fragmentsOf(ringSeeds(on, {impact}, 100)), 100);
}

}  // namespace
}  // namespace sherd
