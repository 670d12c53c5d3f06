// kernels/rough.cl against a walk of one voxel at a time with noise evaluated at that voxel, bit
// for bit; the noise against a function of space; and the height of the relief against the
// requested one.
#include <cmath>
#include <cstdlib>
#include <optional>

#include "base/random.h"
#include "device_fixture.h"
#include "grow/fields/relief.h"
#include "grow_reference.h"

namespace sherd {
namespace {

using openvdb::Coord;
using reference::LabelMap;
using voxel_shapes::VoxelSolid;

constexpr std::int64_t kWord = std::int64_t{1} << 32;

std::int64_t floorDiv(std::int64_t a, std::int64_t b) { return (a - (((a % b) + b) % b)) / b; }

// Bits of an octave's number in hashes.
std::uint64_t bitsOf(int octave) { return static_cast<std::uint64_t>(octave & 0xffff) << 48; }

int latticeValue(std::uint64_t seed, int octave, int axis, const Coord& p) {
  std::uint64_t key = bitsOf(octave);
  for (int i = 0; i < 3; ++i) key |= static_cast<std::uint64_t>(p[i] & 0xffff) << (16 * i);
  const std::uint64_t bits = mixed(seed ^ mixed(key + 0x9e3779b97f4a7c15u));
  return static_cast<int>((bits >> (16 * axis)) & 0xffff) - 32768;
}

// The random shift of a lattice along an axis, in 1/65536 spacing.
int latticeShift(std::uint64_t seed, int octave, int axis) {
  return static_cast<int>((mixed(seed + bitsOf(octave)) >> (16 * axis)) & 0xffff);
}

// t^3 (6 t^2 - 15 t + 10), rounded down; t and the result in 1/2^31.
std::int64_t smoothWeight(std::int64_t t) {
  const std::int64_t t2 = t * t / kWord, t3 = 2 * t2 * t / kWord;
  return t3 * (6 * (t2 / 16) - 15 * (t / 32 + 1) + 10 * (kWord / 64)) / kWord * 128;
}

// Value noise of the n-th octave at one voxel, 1/256 voxel: eight lattice points, blended along z,
// then x, then y.
int noise(std::uint64_t seed, const NoiseOctaves& octaves, std::size_t n, int axis,
          const Coord& voxel) {
  const int octave = octaves.first + static_cast<int>(n), amplitude = octaves.amplitude[n];
  Coord cell;
  std::int64_t weight[3];
  for (int i = 0; i < 3; ++i) {
    const std::int64_t step =
        i == octaves.propagation ? octaves.propagationStep[n] : octaves.step[n];
    const std::int64_t at =
        voxel[i] * step + step / 2 + std::int64_t{latticeShift(seed, octave, i)} * 65536;
    cell[i] = static_cast<int>(floorDiv(at, kWord));
    weight[i] = smoothWeight((at - cell[i] * kWord) / 2);
  }
  const auto value = [&](const Coord& offset) {
    const std::int64_t lattice = latticeValue(seed, octave, axis, cell + offset);
    return floorDiv(lattice * amplitude, 32768);
  };
  const auto blend = [](std::int64_t a, std::int64_t b, std::int64_t w) {
    return a + floorDiv(2 * (b - a) * w, kWord);
  };
  std::int64_t alongZ[2][2], alongX[2];
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      alongZ[i][j] = blend(value({i, j, 0}), value({i, j, 1}), weight[2]);
    }
  }
  for (int j = 0; j < 2; ++j) alongX[j] = blend(alongZ[0][j], alongZ[1][j], weight[0]);
  return static_cast<int>(blend(alongX[0], alongX[1], weight[1]));
}

// The sum of all octaves, 1/256 voxel.
std::int64_t displacement(std::uint64_t seed, const NoiseOctaves& octaves, int axis,
                          const Coord& voxel) {
  std::int64_t sum = 0;
  for (std::size_t n = 0; n < octaves.step.size(); ++n) {
    sum += noise(seed, octaves, n, axis, voxel);
  }
  return sum;
}

Coord wholeVoxels(std::uint64_t seed, const NoiseOctaves& octaves, const Coord& voxel,
                  const std::optional<Coord>& anchor) {
  Coord whole;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t there = anchor ? displacement(seed, octaves, axis, *anchor) : 0;
    whole[axis] =
        static_cast<int>(floorDiv(displacement(seed, octaves, axis, voxel) - there + 128, 256));
  }
  return whole;
}

Coord walk(const std::set<Coord>& inside, Coord at, const Coord& way) {
  const int most = std::max({std::abs(way.x()), std::abs(way.y()), std::abs(way.z())});
  for (int i = 0; i < most; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const int steps = std::abs(way[axis]);
      if ((i + 1) * steps / most == i * steps / most) continue;
      Coord next = at;
      next[axis] += way[axis] < 0 ? -1 : 1;
      if (inside.count(next)) at = next;
    }
  }
  return at;
}

// The smooth labels at the ends of the walks, and the seeds' own.
LabelMap roughReference(const VoxelSolid& solid, const std::vector<Seed>& seeds, std::uint64_t seed,
                        const NoiseOctaves& octaves, const std::optional<Coord>& anchor = {}) {
  const auto smooth = reference::nearest(solid, seeds, Metric::euclidean);
  LabelMap expected;
  for (const Coord& voxel : solid.inside) {
    expected[voxel] =
        smooth.at(walk(solid.inside, voxel, wholeVoxels(seed, octaves, voxel, anchor))).label;
  }
  for (const Seed& s : seeds) expected[s.voxel] = s.fragment;
  return expected;
}

// Growth without the steps after roughening.
GrowOptions roughOptions(const Relief& relief, std::uint64_t seed) {
  return {
      .growth = Growth::nearest,
      .roughness = relief.height,
      .hurst = relief.hurst,
      .roughnessWindow = relief.window,
      .propagationHurst = relief.propagationHurst,
      .propagation = {relief.propagation == 0 ? -2.0 : 0.5, relief.propagation == 1 ? 3.0 : -0.5,
                      relief.propagation == 2 ? -1.0 : 0.25},
      .longestSideVoxels = relief.longestSide,
      .regrowIsolated = false,
      .noiseSeeds = {seed}};
}

class Rough : public DeviceTest {
 protected:
  static LabelMap grown(const VoxelSolid& solid, const std::vector<Seed>& seeds,
                        const GrowOptions& options) {
    return reference::mapOf(grow(voxel_shapes::blocksOf(solid),
                                 std::vector<std::vector<Seed>>{seeds}, device(), options)
                                .front());
  }
};

VoxelSolid movedBy(const VoxelSolid& solid, const Coord& by) {
  VoxelSolid moved{solid.name + ", moved", {}, {}};
  for (const Coord& v : solid.inside) moved.inside.insert(v + by);
  for (const Coord& v : solid.exteriorBand) moved.exteriorBand.insert(v + by);
  return moved;
}

TEST_F(Rough, EqualsTheReferenceWalk) {
  std::vector<VoxelSolid> solids = voxel_shapes::all();
  solids.push_back(movedBy(solids.front(), {-700'003, 40'001, 12'345}));
  std::size_t number = 0;
  for (const VoxelSolid& solid : solids) {
    std::vector<Seed> seeds;
    for (const Coord& voxel : solid.inside) {
      if (mixed(static_cast<std::uint64_t>(voxel.x() * 961 + voxel.y() * 31 + voxel.z())) % 97 == 0)
        seeds.push_back({voxel, static_cast<std::uint16_t>(seeds.size() + 1)});
    }
    if (seeds.empty()) seeds.push_back({*solid.inside.begin(), 1});
    // Spacings of at least 2 voxels, of 2 exactly, of 3.95, and of 8 and more.
    for (const double side : {37.3, 64.0, 126.4, 65536.0}) {
      if (voxel_shapes::small() && number++ % 4 != 0) continue;
      const Relief relief{.height = 2.0, .hurst = 0.7, .window = 6.0, .longestSide = side};
      EXPECT_EQ(grown(solid, seeds, roughOptions(relief, 42)),
                roughReference(solid, seeds, 42, noiseOctaves(relief)))
          << solid.name << ", side " << side;
    }
  }
}

// At an anchor a crack stays where it was, though its relief is tall beside its own height there.
TEST_F(Rough, StaysAtAnAnchor) {
  const VoxelSolid box = voxel_shapes::solidWhere("box", 40, [](const Coord& v) {
    return v.x() >= 0 && v.y() >= 0 && v.z() >= 0 && v.y() < 12 && v.z() < 12;
  });
  const std::vector<Seed> seeds{{{3, 6, 6}, 1}, {{36, 6, 6}, 2}};  // a crack before x = 20
  const Relief relief{.height = 3.0, .hurst = 0.8, .window = 8.0, .longestSide = 64.0};
  const NoiseOctaves octaves = noiseOctaves(relief);
  int far = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    for (const Coord& anchor : {Coord(19, 6, 6), Coord(20, 0, 11), Coord(-70, 3, 5)}) {
      if (voxel_shapes::small() && (seed > 1 || anchor.x() > 19)) continue;
      GrowOptions options = roughOptions(relief, seed);
      options.noiseAnchors = {anchor};
      const LabelMap labels = grown(box, seeds, options);
      EXPECT_EQ(labels, roughReference(box, seeds, seed, octaves, anchor)) << seed << anchor;
      if (box.inside.count(anchor) == 0) continue;
      EXPECT_EQ(labels.at(anchor), anchor.x() < 20 ? 1 : 2);
      far += std::abs(displacement(seed, octaves, 0, anchor)) > 512;
    }
  }
  if (!voxel_shapes::small()) {
    EXPECT_GT(far, 2);
  }
}

TEST_F(Rough, EqualsTheReferenceWalkWithTwoExponents) {
  const std::vector<VoxelSolid> solids = voxel_shapes::all();
  std::size_t number = 0;
  for (const VoxelSolid& solid : solids) {
    std::vector<Seed> seeds;
    for (const Coord& voxel : solid.inside) {
      if (mixed(static_cast<std::uint64_t>(voxel.x() * 961 + voxel.y() * 31 + voxel.z())) % 97 == 0)
        seeds.push_back({voxel, static_cast<std::uint16_t>(seeds.size() + 1)});
    }
    if (seeds.empty()) seeds.push_back({*solid.inside.begin(), 1});
    for (const double side : {37.3, 64.0, 65536.0}) {
      const auto axis = static_cast<std::int32_t>(number++ % 3);
      if (voxel_shapes::small() && number % 4 != 0) continue;
      for (const double along : {0.5, 1.0}) {
        const Relief relief{.height = 2.0,
                            .hurst = 0.7,
                            .window = 6.0,
                            .longestSide = side,
                            .propagationHurst = along,
                            .propagation = axis};
        EXPECT_EQ(grown(solid, seeds, roughOptions(relief, 42)),
                  roughReference(solid, seeds, 42, noiseOctaves(relief)))
            << solid.name << ", side " << side << ", axis " << axis << ", exponent " << along;
      }
    }
  }
}

// Leaves far from the crack are skipped by bounds of their displacements.
TEST_F(Rough, SkipsOnlyLeavesThatKeepTheirLabels) {
  const VoxelSolid solid = voxel_shapes::ball(voxel_shapes::small() ? 12 : 28);
  const std::vector<Seed> seeds{{{-5, 0, 0}, 1}, {{4, 1, 0}, 2}};
  for (std::uint64_t seed = 0; seed < (voxel_shapes::small() ? 1u : 6u); ++seed) {
    const Relief relief{.height = 0.5 + 0.5 * static_cast<double>(seed),
                        .window = 10.0,
                        .longestSide = 50.0 + 17.3 * static_cast<double>(seed)};
    EXPECT_EQ(grown(solid, seeds, roughOptions(relief, seed)),
              roughReference(solid, seeds, seed, noiseOctaves(relief)))
        << "seed " << seed;
  }
}

// A crack between two layers of leaves, lattices little wider than a leaf, and displacements of
// about half a voxel: whether a voxel crosses the crack depends on the lattice points within its
// leaf.
TEST_F(Rough, SkipsNoLeafWithALargeDisplacementInItsMiddle) {
  const int extent = voxel_shapes::small() ? 10 : 56;
  const VoxelSolid solid = voxel_shapes::solidWhere(
      "slab", extent, [](const Coord& v) { return v.x() >= -8 && v.x() < 8; });
  const std::vector<Seed> seeds{{{-5, 0, 0}, 1}, {{4, 0, 0}, 2}};
  for (std::uint64_t seed = 0; seed < (voxel_shapes::small() ? 1u : 4u); ++seed) {
    const Relief relief{.height = 0.05, .hurst = 1.0, .window = 2.0, .longestSide = 136.0};
    EXPECT_EQ(grown(solid, seeds, roughOptions(relief, seed)),
              roughReference(solid, seeds, seed, noiseOctaves(relief)))
        << "seed " << seed;
  }
}

// The same with spacings of 2 voxels along one axis, and of more than a leaf along the others.
TEST_F(Rough, SkipsNoLeafWithTwoExponents) {
  const int extent = voxel_shapes::small() ? 10 : 40;
  const VoxelSolid solid = voxel_shapes::solidWhere(
      "slab", extent, [](const Coord& v) { return v.x() >= -16 && v.x() < 16; });
  const std::vector<Seed> seeds{{{-5, 0, 0}, 1}, {{4, 0, 0}, 2}};
  for (std::uint64_t seed = 0; seed < (voxel_shapes::small() ? 1u : 6u); ++seed) {
    const Relief relief{.height = 0.05 + 0.1 * static_cast<double>(seed),
                        .hurst = seed < 3 ? 1.0 : 0.4,
                        .window = 2.0,
                        .longestSide = 136.0,
                        .propagationHurst = seed < 3 ? 0.5 : 0.9,
                        .propagation = static_cast<std::int32_t>(seed % 3)};
    EXPECT_EQ(grown(solid, seeds, roughOptions(relief, seed)),
              roughReference(solid, seeds, seed, noiseOctaves(relief)))
        << "seed " << seed;
  }
}

TEST_F(Rough, RefusesADirectionOrAnExponentThatIsNone) {
  const VoxelSolid solid = voxel_shapes::ball(5);
  const std::vector<Seed> seeds{{{-2, 0, 0}, 1}, {{2, 0, 0}, 2}};
  const double nan = std::nan(""), infinite = HUGE_VAL;
  for (const glm::dvec3 direction :
       {glm::dvec3{0.0}, glm::dvec3{nan, 1.0, 0.0}, glm::dvec3{1.0, infinite, 0.0}}) {
    EXPECT_THROW(
        grown(solid, seeds, {.roughness = 1.0, .propagationHurst = 0.6, .propagation = direction}),
        Error);
  }
  for (const double hurst : {-0.5, 0.05, 1.1, nan}) {
    EXPECT_THROW(grown(solid, seeds, {.roughness = 1.0, .propagationHurst = hurst}), Error);
  }
}

TEST_F(Rough, WithoutALongestSideItIsThatOfTheInsideVoxels) {
  const VoxelSolid solid = voxel_shapes::solidWhere(
      "box", 12, [](const Coord& v) { return v.x() >= -3 && v.x() < 8 && v.z() > 0; });
  const std::vector<Seed> seeds{{{-2, -3, 4}, 1}, {{6, 4, 9}, 2}};
  const Relief relief{.height = 1.5, .window = 2.5, .longestSide = 25.0};
  GrowOptions options = roughOptions(relief, 5);
  options.longestSideVoxels = 0.0;
  options.roughnessWindow = 0.0;
  EXPECT_EQ(grown(solid, seeds, options), roughReference(solid, seeds, 5, noiseOctaves(relief)));
}

// What rounding adds to an octave, at most, 1/256 voxel.  A lattice value is rounded by 1, its
// amplitude by 1/2, and each of three blends by 1.  Weights are rounded by less than 8 * 2^-24.
// Coordinates in the lattice, of voxels below 512, are rounded by less than 513 * 2^-33 of a
// spacing, where the slope is at most 15/8 of the difference of two lattice values.  Along each
// axis both together are less than 2^-19 of the amplitude, and along all less than 0.1 if that is
// below 2^14.
constexpr double kRoundingPerOctave = 4.6;

// The crack between two seeds in a box whose voxels are three times as fine the second time.  The
// center of voxel i is that of voxel 3 i + 1 of the finer ones.  The displacement along x decides
// on the side of the crack; where it ends further from the crack than the finer octaves, rounding
// to whole voxels and rounding of noise reach, the label is the same.
TEST_F(Rough, TheSameSeedGivesTheSameCrackInFinerVoxels) {
  const auto box = [](int fine) {
    return voxel_shapes::solidWhere("box", 32 * fine - 1, [=](const Coord& v) {
      return v.x() >= 0 && v.y() >= 0 && v.z() >= 0 && v.y() < 16 * fine && v.z() < 16 * fine;
    });
  };
  if (voxel_shapes::small()) GTEST_SKIP() << "takes long on simulated devices";
  const VoxelSolid coarse = box(1), fine = box(3);
  const auto reliefAt = [](double fineness) {
    return Relief{.height = 2.5 * fineness,
                  .hurst = 0.9,
                  .window = 3.24 * fineness,
                  .longestSide = 32.4 * fineness};
  };
  const std::vector<Seed> coarseSeeds{{{8, 8, 8}, 1}, {{23, 8, 8}, 2}};
  const std::vector<Seed> fineSeeds{{{25, 25, 25}, 1}, {{70, 25, 25}, 2}};
  const NoiseOctaves octaves = noiseOctaves(reliefAt(3.0));
  const std::size_t resolved = noiseOctaves(reliefAt(1.0)).step.size();
  ASSERT_LT(resolved, octaves.step.size());
  double reach = 0.5 + 2.0 * static_cast<double>(octaves.step.size()) * kRoundingPerOctave / 256.0;
  for (std::size_t n = resolved; n < octaves.step.size(); ++n) {
    reach += octaves.amplitude[n] / 256.0 / 3.0;
  }
  for (const std::uint64_t seed : {3u, 4u, 5u}) {
    const LabelMap labels = grown(coarse, coarseSeeds, roughOptions(reliefAt(1.0), seed));
    const LabelMap fineLabels = grown(fine, fineSeeds, roughOptions(reliefAt(3.0), seed));
    int compared = 0, moved = 0;
    for (const auto& [voxel, label] : labels) {
      if (voxel == coarseSeeds[0].voxel || voxel == coarseSeeds[1].voxel) continue;
      const Coord same(3 * voxel.x() + 1, 3 * voxel.y() + 1, 3 * voxel.z() + 1);
      const double end = voxel.x() - 15.5 +
                         static_cast<double>(displacement(seed, octaves, 0, same)) / 256.0 / 3.0;
      if (std::abs(end) <= reach) continue;
      ++compared;
      moved += (end < 0.0) != (voxel.x() < 15.5);
      ASSERT_EQ(label, end < 0.0 ? 1 : 2) << voxel;
      ASSERT_EQ(fineLabels.at(same), label) << voxel;
    }
    EXPECT_GT(compared, 32 * 16 * 16 / 2);
    EXPECT_GT(moved, 0);
  }
}

// Value noise in space: p is a position from the low corner of the box in units of its longest
// side.  The largest lattice value is 1.
double noiseInSpace(std::uint64_t seed, int octave, int axis, const double (&p)[3]) {
  Coord cell;
  double weight[3];
  for (int i = 0; i < 3; ++i) {
    const double at = p[i] * std::ldexp(1.0, octave) + latticeShift(seed, octave, i) / 65536.0;
    cell[i] = static_cast<int>(std::floor(at));
    const double t = at - cell[i];
    weight[i] = t * t * t * (6.0 * t * t - 15.0 * t + 10.0);
  }
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const Coord offset(corner >> 2, corner >> 1 & 1, corner & 1);
    double share = latticeValue(seed, octave, axis, cell + offset) / 32768.0;
    for (int i = 0; i < 3; ++i) share *= offset[i] ? weight[i] : 1.0 - weight[i];
    sum += share;
  }
  return sum;
}

// At every resolution the noise of a voxel is that function at its center, up to rounding, with
// amplitudes that are the same lengths; only the octaves that the voxels do not resolve are
// missing.
TEST(RoughNoise, IsAFunctionOfSpace) {
  const auto reliefAt = [](double side) {
    return Relief{.height = 0.02 * side, .hurst = 0.7, .window = 0.1 * side, .longestSide = side};
  };
  constexpr double kAllResolved = 8192.0;
  const NoiseOctaves all = noiseOctaves(reliefAt(kAllResolved));
  EXPECT_EQ(all.first, 1);
  EXPECT_EQ(all.step.size(), 12u);
  for (const double side : {48.0, 70.3, 96.0, 409.7}) {
    const NoiseOctaves octaves = noiseOctaves(reliefAt(side));
    EXPECT_EQ(octaves.first, all.first);
    EXPECT_EQ(octaves.step.size(), static_cast<std::size_t>(std::floor(std::log2(side / 2.0))));
    for (std::size_t n = 0; n < octaves.step.size(); ++n) {
      const int octave = octaves.first + static_cast<int>(n);
      // Each is rounded to 1/256 voxel.
      const double amplitude = all.amplitude[n] * side / kAllResolved;
      EXPECT_NEAR(octaves.amplitude[n], amplitude, 0.5 + 0.5 * side / kAllResolved);
      for (std::uint64_t i = 0; i < 500; ++i) {
        const auto draw = [&](std::uint64_t k) {
          return static_cast<int>(mixed(3 * i + k) % static_cast<std::uint64_t>(side + 20)) - 10;
        };
        const Coord voxel(draw(0), draw(1), draw(2));
        const double at[3] = {(voxel.x() + 0.5) / side, (voxel.y() + 0.5) / side,
                              (voxel.z() + 0.5) / side};
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_NEAR(noise(77, octaves, n, axis, voxel),
                      amplitude * noiseInSpace(77, octave, axis, at), kRoundingPerOctave + 0.05)
              << "side " << side << ", octave " << octave << ", voxel " << voxel;
        }
      }
    }
  }
}

constexpr double kHeight = 3.0;
constexpr int kWindow = 24;

// The root of the mean variance of the displacement within windows of kWindow, along some axes.
double heightInWindows(const NoiseOctaves& octaves, int windows, const std::vector<int>& axes) {
  double variance = 0.0;
  for (int w = 0; w < windows; ++w) {
    const std::uint64_t seed = 1000 + static_cast<std::uint64_t>(w);
    const Coord corner(static_cast<int>(mixed(seed) % 512), static_cast<int>(mixed(seed + 7) % 512),
                       static_cast<int>(mixed(seed + 9) % 512));
    for (const int axis : axes) {
      double sum = 0.0, squares = 0.0;
      int n = 0;
      for (int y = 0; y < kWindow; y += 2) {
        for (int z = 0; z < kWindow; z += 2, ++n) {
          const double d =
              static_cast<double>(displacement(seed, octaves, axis, corner + Coord(0, y, z))) /
              256.0;
          sum += d;
          squares += d * d;
        }
      }
      variance += squares / n - sum / n * (sum / n);
    }
  }
  return std::sqrt(variance / (static_cast<double>(axes.size()) * windows));
}

// Over many windows the mean variance of the displacement within a window is the requested one.
// 200 windows with 3 components are 600 nearly independent estimates.  A few long waves dominate
// the variance in a window, so one estimate has a relative error of about 1, and the mean of 1 /
// sqrt(600) = 4 %.  5 sigma are 20 % of the variance, 10 % of the height.
TEST(RoughNoise, HasTheRequestedHeight) {
  const NoiseOctaves octaves =
      noiseOctaves({.height = kHeight, .window = kWindow, .longestSide = 240.0});
  EXPECT_NEAR(heightInWindows(octaves, 200, {0, 1, 2}), kHeight, 0.1 * kHeight);
}

// With two exponents the same, over windows with one side along the axis of propagation: 300 of two
// components each, as many estimates.
TEST(RoughNoise, HasTheRequestedHeightWithTwoExponents) {
  for (const double along : {0.5, 1.0}) {
    const NoiseOctaves octaves = noiseOctaves({.height = kHeight,
                                               .hurst = 0.75,
                                               .window = kWindow,
                                               .longestSide = 240.0,
                                               .propagationHurst = along,
                                               .propagation = 1});
    EXPECT_NEAR(heightInWindows(octaves, 300, {0, 2}), kHeight, 0.1 * kHeight) << along;
  }
}

// Spacings s and t and amplitudes a of all octaves: a is proportional to s^hurst and to
// t^propagationHurst, which makes heights scale with these exponents; s = t at the longest side;
// and the smaller spacing is S / 2^k.  Steps are rounded to 2^-32, amplitudes to 1/256 voxel, and
// the first octave is wider.
TEST(RoughNoise, OctavesScaleByBothExponents) {
  constexpr double kSide = 8192.0;
  for (const double hurst : {0.4, 0.75, 1.0}) {
    for (const double along : {0.6, 0.75, 1.0}) {
      const NoiseOctaves octaves = noiseOctaves({.height = 100.0,
                                                 .hurst = hurst,
                                                 .window = 0.1 * kSide,
                                                 .longestSide = kSide,
                                                 .propagationHurst = along,
                                                 .propagation = 0});
      ASSERT_EQ(octaves.first, 1);
      ASSERT_EQ(octaves.step.size(), 12u);
      ASSERT_EQ(octaves.propagation, 0);
      for (std::size_t n = 1; n < octaves.step.size(); ++n) {
        const double s = std::ldexp(1.0, 32) / static_cast<double>(octaves.step[n]),
                     t = std::ldexp(1.0, 32) / static_cast<double>(octaves.propagationStep[n]);
        const double octave = octaves.first + static_cast<double>(n);
        EXPECT_NEAR(std::min(s, t), kSide * std::exp2(-octave), 1e-3);
        EXPECT_NEAR(std::log(t / kSide) * along, std::log(s / kSide) * hurst, 1e-4);
        const double a = octaves.amplitude[n], b = octaves.amplitude[1];
        const double s1 = std::ldexp(1.0, 32) / static_cast<double>(octaves.step[1]);
        EXPECT_NEAR(a, b * std::pow(s / s1, hurst), 1.0) << hurst << ' ' << along << ' ' << n;
      }
    }
  }
}

TEST(RoughNoise, EqualExponentsAreOne) {
  const Relief one{.height = 3.0, .hurst = 0.7, .window = 24.0, .longestSide = 240.0};
  Relief two = one;
  two.propagationHurst = two.hurst;
  const NoiseOctaves a = noiseOctaves(one), b = noiseOctaves(two);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.step, a.propagationStep);
  EXPECT_EQ(b.step, b.propagationStep);
  EXPECT_EQ(a.amplitude, b.amplitude);
}

// Lengths far from those of the voxels.
TEST(RoughNoise, HasOctavesForEveryWindow) {
  for (const double side : {1.0, 14.0, 4096.0, 1e6}) {
    for (const double window : {1e-300, 0.1, 1.0, side, 1e6, 1e300}) {
      for (const double hurst : {0.1, 1.0}) {
        const NoiseOctaves octaves = noiseOctaves({.height = 100.0,
                                                   .hurst = hurst,
                                                   .window = window,
                                                   .longestSide = side,
                                                   .propagationHurst = 1.1 - hurst});
        ASSERT_GE(octaves.step.size(), 1u) << side << ' ' << window;
        EXPECT_LE(octaves.step.size(), 21u);
        for (std::size_t n = 0; n < octaves.step.size(); ++n) {
          EXPECT_GE(octaves.step[n], 0);
          EXPECT_LE(octaves.step[n], std::int64_t{1} << 31);
          EXPECT_GE(octaves.propagationStep[n], 0);
          EXPECT_LE(octaves.propagationStep[n], std::int64_t{1} << 31);
          EXPECT_GE(octaves.amplitude[n], 0);
          EXPECT_LE(octaves.amplitude[n], 1 << 22);
        }
      }
    }
  }
}

}  // namespace
}  // namespace sherd
