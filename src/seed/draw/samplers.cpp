// Seed samplers: uniform, Halton, Gaussian, Poisson-disk.
#include "seed/draw/samplers.h"

#include <algorithm>
#include <cmath>

#include "base/cancel_flag.h"
#include "seed/draw/irwin_hall.h"
#include "seed/draw/poisson.h"
#include "seed/draw/radical_inverse.h"

namespace sherd {

void SeedSampler::draw(std::size_t count, Chosen& chosen) {
  const std::size_t end = chosen.size() + count;
  switch (sampler_) {
    case Sampler::uniform:
      break;
    case Sampler::halton:
      drawHalton(end, chosen);
      break;
    case Sampler::gaussian:
      drawEach(
          [this](std::uint64_t item) {
            // The mean of 12 uniforms has a standard deviation of 1/12; this scales it to a quarter
            // of the box.
            constexpr double kSide = kNormalTerms / 4.0;
            glm::dvec3 point;
            for (int axis = 0; axis < 3; ++axis) {
              point[axis] =
                  0.5 + kSide * meanOfUniforms(kNormalTerms, seed_, Stage::gaussianSeed,
                                               item * 3 + static_cast<std::uint64_t>(axis));
            }
            return point;
          },
          end, end, chosen);
      break;
    case Sampler::poisson:
      drawApart(
          candidates_, seed_, end, next_, chosen, [&] { drawAnew(end, chosen); }, progress_);
      break;
  }
  drawUniform(end, end, chosen);
}

void SeedSampler::drawUniform(std::size_t upTo, std::size_t end, Chosen& chosen) {
  drawEach([this](std::uint64_t item) { return randomPoint(seed_, Stage::seedPoint, item); }, upTo,
           end, chosen);
}

void SeedSampler::drawAnew(std::size_t end, Chosen& chosen) {
  drawUniform(chosen.size() + 1, end, chosen);
}

// A seed whose draws meet kTaken taken voxels, or miss the solid too often, takes any free voxel,
// so that as many seeds as voxels can be drawn.
void SeedSampler::drawEach(const PointOf& pointOf, std::size_t upTo, std::size_t end,
                           Chosen& chosen) {
  constexpr int kTaken = 16;
  constexpr std::uint64_t kMostDraws = (1 << 20) - 1;  // of drawItem
  for (; chosen.size() < upTo; ++nextSeed_) {
    throwIfCancelled(progress_);
    const std::size_t before = chosen.size();
    const bool covers = end - before <= chosen.unseeded();
    std::uint64_t draws = covers ? coverDraws_ : candidates_.drawsForOne();
    int taken = 0;
    for (std::uint64_t i = 0; i < draws && taken < kTaken && chosen.size() == before; ++i) {
      coverDraws_ -= covers ? 1 : 0;
      const std::uint64_t item = drawItem(nextSeed_, i);
      const glm::dvec3 point = pointOf(item);
      if (std::min({point.x, point.y, point.z}) < 0.0 ||
          std::max({point.x, point.y, point.z}) >= 1.0) {
        continue;
      }
      const std::optional<Candidate> found = candidates_.inBox(point);
      if (found && !isAccepted(point, item)) {  // not one of the draws that miss the solid
        draws += !covers && refusals_ > 0 && draws < kMostDraws ? 1 : 0;
        continue;
      }
      if (found && chosen.mayTake(*found, end) && !chosen.add(*found)) ++taken;
    }
    if (chosen.size() == before) addAny(end, chosen);
    nextSeed_ += chosen.size() - before - 1;  // several, where components get a voxel each
  }
}

bool SeedSampler::isAccepted(const glm::dvec3& unit, std::uint64_t item) {
  if (density_.accepts(candidates_.pointInBox(unit), item)) return true;
  if (refusals_ % 4096 == 0) throwIfCancelled(progress_);
  refusals_ -= refusals_ > 0 ? 1 : 0;
  return false;
}

Candidate SeedSampler::denseCandidate(const Chosen& chosen) {
  if (!dense_) dense_.emplace(candidates_.voxels(), density_, progress_);
  return candidates_.ofVoxel(dense_->draw(randomUnit(seed_, Stage::denseVoxel, nextVoxel_++),
                                          [&](VoxelKey key) { return !chosen.has(key); }));
}

void SeedSampler::addAny(std::size_t end, Chosen& chosen) {
  const VoxelIndex& voxels = candidates_.voxels();
  if (end - chosen.size() > chosen.unseeded()) {
    if (density_.hasField()) {
      chosen.add(denseCandidate(chosen));
      return;
    }
    std::uint64_t number = randomBelow(voxels.total(), seed_, Stage::seedVoxel, nextVoxel_++);
    while (!chosen.add(candidates_.ofVoxel(voxels.at(number))))
      number = (number + 1) % voxels.total();
    return;
  }
  const VoxelComponents& components = chosen.components();
  const std::vector<std::uint64_t> room = voxels.countInComponents(components);
  std::vector<std::uint64_t> number;
  for (std::uint32_t component = 0; component < components.count(); ++component)
    number.push_back(randomBelow(room[component], seed_, Stage::componentSeed, component));
  const std::vector<VoxelKey> any = voxels.atInComponents(components, std::move(number));
  for (std::uint32_t component = 0; component < components.count(); ++component) {
    if (!chosen.isSeeded(component)) chosen.add(candidates_.ofVoxel(any[component]));
  }
}

void SeedSampler::drawHalton(std::size_t end, Chosen& chosen) {
  // Enough digits for 2^28 draws.
  const RadicalInverse inX(2, 28, seed_, Stage::haltonDigit), inY(3, 18, seed_, Stage::haltonDigit),
      inZ(5, 13, seed_, Stage::haltonDigit);
  constexpr std::uint64_t kMost = 1 << 24, kHaltonItem = std::uint64_t{1} << 63;
  std::uint64_t left = std::min(kMost, candidates_.drawsForOne() * (end - chosen.size()) + 1024);
  // The mesh alone decides which points are skipped.  Where a point has no free voxel, its seed is
  // drawn anew.  Once only components without a seed are left, points hardly ever lie in them.
  for (; left > 0 && end - chosen.size() > chosen.unseeded(); --left, ++next_) {
    throwIfCancelled(progress_);
    const glm::dvec3 point(inX.at(next_), inY.at(next_), inZ.at(next_));
    const auto found = candidates_.inBox(point);
    if (!found) continue;
    if (!isAccepted(point, kHaltonItem | next_)) {
      left += left < kMost ? 1 : 0;
      continue;
    }
    if (!chosen.add(*found)) drawAnew(end, chosen);
  }
}

}  // namespace sherd
