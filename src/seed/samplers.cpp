// Where seeds are drawn.
#include "seed/samplers.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "seed/irwin_hall.h"
#include "seed/poisson.h"
#include "seed/radical_inverse.h"

namespace sherd {

std::vector<VoxelKey> onePerPart(const VoxelIndex& candidates, const Parts& parts,
                                 std::span<const std::uint64_t> inPart, std::uint64_t seed) {
  std::vector<std::uint64_t> number;
  for (std::size_t part = 0; part < parts.count(); ++part) {
    number.push_back(randomBelow(inPart[part], seed, Stage::partSeed, part));
  }
  return candidates.atInParts(parts, std::move(number));
}

void SeedSampler::draw(std::size_t count, Chosen& chosen) {
  const std::size_t end = chosen.size() + count;
  switch (sampler_) {
    case Sampler::uniform:
      break;
    case Sampler::halton:
      drawHalton(end, chosen);
      break;
    case Sampler::gaussian:
      drawGaussian(end, chosen);
      break;
    case Sampler::poisson:
      drawApart(candidates_, box_, seed_, end, next_, chosen);
      break;
  }
  drawUniform(end, chosen);
}

// 64 times what a box of evenly spread candidates would take, and at most some seconds' worth.
std::uint64_t SeedSampler::tries(std::size_t count) const {
  constexpr double kMost = 1 << 24;
  const openvdb::Coord dims = box_.dims();
  const double expected = static_cast<double>(count) * dims.x() * dims.y() * dims.z() /
                          static_cast<double>(candidates_.total());
  return static_cast<std::uint64_t>(std::min(kMost, 64.0 * expected + 1024.0));
}

void SeedSampler::drawHalton(std::size_t end, Chosen& chosen) {
  // Places enough for 2^28 draws.
  const RadicalInverse inX(2, 28, seed_, Stage::haltonDigit), inY(3, 18, seed_, Stage::haltonDigit),
      inZ(5, 13, seed_, Stage::haltonDigit);
  const openvdb::Coord dims = box_.dims();
  const auto along = [&](const RadicalInverse& inverse, int axis) {
    return static_cast<int>(inverse.below(static_cast<std::uint64_t>(dims[axis]), next_));
  };
  for (std::uint64_t left = tries(end - chosen.size()); left > 0 && chosen.size() < end; --left) {
    const openvdb::Coord voxel =
        box_.min + openvdb::Coord(along(inX, 0), along(inY, 1), along(inZ, 2));
    ++next_;
    if (const auto key = candidates_.find(voxel)) chosen.add(*key);
  }
}

void SeedSampler::drawGaussian(std::size_t end, Chosen& chosen) {
  const openvdb::Coord dims = box_.dims();
  // The mean of 12 uniforms has a standard deviation of 1/12, so this gives a quarter of the box.
  constexpr double kSide = kNormalTerms / 4.0;
  for (std::uint64_t left = tries(end - chosen.size()); left > 0 && chosen.size() < end; --left) {
    openvdb::Coord voxel;
    for (int axis = 0; axis < 3; ++axis) {
      const double draw = meanOfUniforms(kNormalTerms, seed_, Stage::gaussianSeed,
                                         next_ * 3 + static_cast<std::uint64_t>(axis));
      const double fromLow = dims[axis] * (0.5 + kSide * draw);
      voxel[axis] = box_.min[axis] + static_cast<int>(std::floor(fromLow));
    }
    ++next_;
    if (const auto key = candidates_.find(voxel)) chosen.add(*key);
  }
}

// A draw that hits a taken voxel goes on to the next free one, so that asking for as many pieces
// as voxels ends too.
void SeedSampler::drawUniform(std::size_t end, Chosen& chosen) {
  for (; chosen.size() < end; ++nextUniform_) {
    std::uint64_t number = randomBelow(candidates_.total(), seed_, Stage::seedVoxel, nextUniform_);
    while (!chosen.add(candidates_.at(number))) number = (number + 1) % candidates_.total();
  }
}

}  // namespace sherd
