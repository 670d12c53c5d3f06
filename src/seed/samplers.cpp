// Seed samplers: uniform, Halton, Gaussian, Poisson-disk.
#include "seed/samplers.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "seed/irwin_hall.h"
#include "seed/poisson.h"
#include "seed/radical_inverse.h"

namespace sherd {

std::vector<VoxelKey> onePerComponent(const VoxelIndex& candidates,
                                      const VoxelComponents& components,
                                      std::span<const std::uint64_t> inComponent,
                                      std::uint64_t seed) {
  std::vector<std::uint64_t> number;
  for (std::size_t component = 0; component < components.count(); ++component) {
    number.push_back(randomBelow(inComponent[component], seed, Stage::componentSeed, component));
  }
  return candidates.atInComponents(components, std::move(number));
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

// Returns 64 times the expected number of draws for candidates spread evenly over the box, limited
// to a few seconds of work.
std::uint64_t SeedSampler::maxTries(std::size_t count) const {
  constexpr double kMost = 1 << 24;
  const openvdb::Coord dims = box_.dims();
  const double expected = static_cast<double>(count) * dims.x() * dims.y() * dims.z() /
                          static_cast<double>(candidates_.total());
  return static_cast<std::uint64_t>(std::min(kMost, 64.0 * expected + 1024.0));
}

void SeedSampler::drawHalton(std::size_t end, Chosen& chosen) {
  // Enough digits for 2^28 draws.
  const RadicalInverse inX(2, 28, seed_, Stage::haltonDigit), inY(3, 18, seed_, Stage::haltonDigit),
      inZ(5, 13, seed_, Stage::haltonDigit);
  const openvdb::Coord dims = box_.dims();
  const auto along = [&](const RadicalInverse& inverse, int axis) {
    return static_cast<int>(inverse.below(static_cast<std::uint64_t>(dims[axis]), next_));
  };
  for (std::uint64_t left = maxTries(end - chosen.size()); left > 0 && chosen.size() < end;
       --left) {
    const openvdb::Coord voxel =
        box_.min + openvdb::Coord(along(inX, 0), along(inY, 1), along(inZ, 2));
    ++next_;
    if (const auto key = candidates_.find(voxel)) chosen.add(*key);
  }
}

void SeedSampler::drawGaussian(std::size_t end, Chosen& chosen) {
  const openvdb::Coord dims = box_.dims();
  // The mean of 12 uniforms has a standard deviation of 1/12; this scales it to a quarter of the
  // box.
  constexpr double kSide = kNormalTerms / 4.0;
  for (std::uint64_t left = maxTries(end - chosen.size()); left > 0 && chosen.size() < end;
       --left) {
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

// A draw that hits a taken voxel moves on to the next free one, so that as many seeds as voxels can
// be drawn.
void SeedSampler::drawUniform(std::size_t end, Chosen& chosen) {
  for (; chosen.size() < end; ++nextUniform_) {
    std::uint64_t number = randomBelow(candidates_.total(), seed_, Stage::seedVoxel, nextUniform_);
    while (!chosen.add(candidates_.at(number))) number = (number + 1) % candidates_.total();
  }
}

}  // namespace sherd
