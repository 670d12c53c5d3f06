// kernels/rough.cl against a walk of one voxel at a time with noise evaluated at that voxel, bit
// for bit; and the height of the relief against the requested one.
#include <cmath>
#include <cstdlib>

#include "base/random.h"
#include "device_fixture.h"
#include "grow/relief.h"
#include "grow_reference.h"

namespace sherd {
namespace {

using openvdb::Coord;
using reference::LabelMap;
using voxel_shapes::VoxelSolid;

std::int64_t floorDiv(std::int64_t a, std::int64_t b) { return (a - (((a % b) + b) % b)) / b; }

int latticeValue(std::uint64_t seed, int octave, int axis, const Coord& p) {
  std::uint64_t key = static_cast<std::uint64_t>(octave) << 48;
  for (int i = 0; i < 3; ++i) key |= static_cast<std::uint64_t>(p[i] & 0xffff) << (16 * i);
  const std::uint64_t bits = mixed(seed ^ mixed(key + 0x9e3779b97f4a7c15u));
  return static_cast<int>((bits >> (16 * axis)) & 0xffff) - 32768;
}

// Value noise at one voxel, 1/256 voxel: eight lattice points, blended along x, then y, then z.
int noise(std::uint64_t seed, int octave, int axis, int amplitude, const Coord& voxel) {
  const int spacing = 2 << octave;
  Coord at = voxel;  // in the lattice, shifted by a random number of leaves
  const std::uint64_t bits = mixed(seed + (static_cast<std::uint64_t>(octave) << 48));
  for (int i = 0; spacing >= 16 && i < 3; ++i) {
    at[i] += 8 * static_cast<int>((bits >> (16 * i)) % static_cast<std::uint64_t>(spacing / 8));
  }
  Coord cell;
  std::int64_t weight[3];
  for (int i = 0; i < 3; ++i) {
    cell[i] = static_cast<int>(floorDiv(at[i], spacing));
    const std::int64_t t = (at[i] - cell[i] * spacing) * (32768 / spacing);
    const std::int64_t t2 = t * t / 32768, t3 = t2 * t / 32768;
    weight[i] = t3 * (6 * t2 - 15 * t + 10 * 32768) / 32768;
  }
  const auto value = [&](const Coord& offset) {
    const std::int64_t lattice = latticeValue(seed, octave, axis, cell + offset);
    return floorDiv(lattice * amplitude, 32768);
  };
  const auto blend = [](std::int64_t a, std::int64_t b, std::int64_t w) {
    return a + floorDiv((b - a) * w, 32768);
  };
  std::int64_t alongX[2][2], alongY[2];
  for (int j = 0; j < 2; ++j) {
    for (int k = 0; k < 2; ++k) {
      alongX[j][k] = blend(value({0, j, k}), value({1, j, k}), weight[0]);
    }
  }
  for (int k = 0; k < 2; ++k) alongY[k] = blend(alongX[0][k], alongX[1][k], weight[1]);
  return static_cast<int>(blend(alongY[0], alongY[1], weight[2]));
}

Coord displacement(std::uint64_t seed, const std::vector<std::int32_t>& amplitudes,
                   const Coord& voxel) {
  Coord whole;
  for (int axis = 0; axis < 3; ++axis) {
    std::int64_t sum = 0;
    for (std::size_t o = 0; o < amplitudes.size(); ++o) {
      sum += noise(seed, static_cast<int>(o), axis, amplitudes[o], voxel);
    }
    whole[axis] = static_cast<int>(floorDiv(sum + 128, 256));
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

using Rough = DeviceTest;

TEST_F(Rough, EqualsTheReferenceWalk) {
  for (const VoxelSolid& solid : voxel_shapes::all()) {
    const auto blocks = voxel_shapes::blocksOf(solid);
    std::vector<Seed> seeds;
    for (const Coord& voxel : solid.inside) {
      if (mixed(static_cast<std::uint64_t>(voxel.x() * 961 + voxel.y() * 31 + voxel.z())) % 97 == 0)
        seeds.push_back({voxel, static_cast<std::uint16_t>(seeds.size() + 1)});
    }
    if (seeds.empty()) seeds.push_back({*solid.inside.begin(), 1});
    GrowOptions options{.growth = Growth::nearest,
                        .roughness = 2.0,
                        .hurst = 0.7,
                        .roughnessWindow = 6.0,
                        .regrowIsolated = false,
                        .noiseSeeds = {42}};
    const LabelMap rough = reference::mapOf(
        grow(blocks, std::vector<std::vector<Seed>>{seeds}, device(), options).front());
    const auto smooth = reference::nearest(solid, seeds, Metric::euclidean);
    const std::vector<std::int32_t> amplitudes = octaveAmplitudes(2.0, 0.7, 6.0);
    LabelMap expected;
    for (const Coord& voxel : solid.inside) {
      expected[voxel] =
          smooth.at(walk(solid.inside, voxel, displacement(42, amplitudes, voxel))).label;
    }
    for (const Seed& seed : seeds) expected[seed.voxel] = seed.fragment;
    EXPECT_EQ(rough, expected) << solid.name;
  }
}

// Over many windows the mean variance of the displacement within a window is the requested one.
// 200 windows with 3 components are 600 nearly independent estimates.  A few long waves dominate
// the variance in a window, so one estimate has a relative error of about 1, and the mean of 1 /
// sqrt(600) = 4 %.  5 sigma are 20 % of the variance, 10 % of the height.
TEST(RoughAmplitudes, GiveTheRequestedHeight) {
  constexpr double kHeight = 3.0, kWindow = 24.0;
  const std::vector<std::int32_t> amplitudes = octaveAmplitudes(kHeight, 0.8, kWindow);
  double variance = 0.0;
  constexpr int kWindows = 200;
  for (int w = 0; w < kWindows; ++w) {
    const std::uint64_t seed = 1000 + static_cast<std::uint64_t>(w);
    const Coord corner(static_cast<int>(mixed(seed) % 512), static_cast<int>(mixed(seed + 7) % 512),
                       static_cast<int>(mixed(seed + 9) % 512));
    for (int axis = 0; axis < 3; ++axis) {
      double sum = 0.0, squares = 0.0;
      int n = 0;
      for (int y = 0; y < 24; y += 2) {
        for (int z = 0; z < 24; z += 2, ++n) {
          double d = 0.0;
          for (std::size_t o = 0; o < amplitudes.size(); ++o) {
            d += noise(seed, static_cast<int>(o), axis, amplitudes[o], corner + Coord(0, y, z)) /
                 256.0;
          }
          sum += d;
          squares += d * d;
        }
      }
      variance += squares / n - sum / n * (sum / n);
    }
  }
  EXPECT_NEAR(std::sqrt(variance / (3 * kWindows)), kHeight, 0.1 * kHeight);
}

}  // namespace
}  // namespace sherd
