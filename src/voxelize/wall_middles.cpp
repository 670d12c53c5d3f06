// Ways from voxels to the middle of their wall, between samples at every second voxel.
#include "voxelize/wall_middles.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "base/cancel_flag.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/wall_normals.h"
#include "voxelize/wall_samples.h"

namespace sherd {
namespace {

// The samples of a leaf and of those next to it on the higher sides.
class SamplesAround {
 public:
  SamplesAround(const LeafBlocks& blocks, std::span<const WallSample> samples, std::size_t leaf) {
    for (int k = 0; k < 8; ++k) {
      const openvdb::Coord offset(8 * (k >> 2), 8 * (k >> 1 & 1), 8 * (k & 1));
      const std::uint32_t at = k == 0 ? static_cast<std::uint32_t>(leaf)
                                      : findLeaf(blocks, blocks.origins[leaf] + offset);
      for (std::size_t i = 0; i < kWallSamples && at != LeafBlocks::kNone; ++i) {
        const WallSample& sample = samples[std::size_t{at} * kWallSamples + i];
        near_[static_cast<std::size_t>(k)] = &samples[std::size_t{at} * kWallSamples];
        hasSamples_ = hasSamples_ || sample.weight > 0.0F;
      }
    }
  }

  bool hasSamples() const { return hasSamples_; }

  // Returns the way to the middle from a voxel of the leaf: the mean of those to the planes in the
  // middle of the wall at the samples around it, as far as these are known.
  glm::dvec3 wayFrom(const glm::ivec3& at) const {
    glm::dvec3 sum(0.0);
    int known = 0;
    const glm::ivec3 low(at.x / 2, at.y / 2, at.z / 2), high = at - low;  // high = (at + 1) / 2
    for (int x = low.x; x <= high.x; ++x) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int z = low.z; z <= high.z; ++z) {
          const WallSample* const sample = find(x, y, z);
          if (sample == nullptr || !sample->isKnown) continue;
          ++known;
          const glm::dvec3 normal(sample->normal), to(glm::ivec3(2 * x, 2 * y, 2 * z) - at);
          sum += sample->weight * (glm::dot(to, normal) + sample->toMiddle) * normal;
        }
      }
    }
    return known > 0 ? sum / static_cast<double>(known) : sum;
  }

 private:
  const WallSample* find(int x, int y, int z) const {
    const auto leaf = static_cast<std::size_t>(x >> 2 << 2 | y >> 2 << 1 | z >> 2);
    const WallSample* const samples = near_[leaf];
    return samples == nullptr ? nullptr : samples + ((x & 3) << 4 | (y & 3) << 2 | (z & 3));
  }

  std::array<const WallSample*, 8> near_{};
  bool hasSamples_ = false;
};

// Sets the ways of a leaf's voxels; returns the longest along an axis.
int setWays(const LeafBlocks& blocks, const SamplesAround& samples, std::size_t leaf,
            std::span<std::int16_t> ways) {
  int reach = 0;
  for (int v = 0; v < 512; ++v) {
    const std::size_t at = leaf * 512 + static_cast<std::size_t>(v);
    const std::uint64_t bit = std::uint64_t{1} << (v % 64);
    if (!blocks.isInside(at) && (blocks.exteriorBand[at / 64] & bit) == 0) continue;
    const glm::dvec3 steps =
        double{WallMiddles::kSteps} * samples.wayFrom({v >> 6, v >> 3 & 7, v & 7});
    for (int axis = 0; axis < 3; ++axis) {
      const double limited = std::clamp(std::floor(steps[axis] + 0.5), -32767.0, 32767.0);
      ways[at * 3 + static_cast<std::size_t>(axis)] = static_cast<std::int16_t>(limited);
      reach = std::max(reach, std::abs(static_cast<int>(limited)));
    }
  }
  return reach;
}

}  // namespace

double WallMiddles::mostOf(const Solid& solid) {
  return 0.5 * std::cbrt(static_cast<double>(solid.voxels));
}

WallMiddles::WallMiddles(const Solid& solid, std::span<const glm::dmat3> normals, double most,
                         const Progress* progress)
    : blocks_(solid.blocks), ways_(solid.blocks->count() * 512 * 3, 0) {
  const LeafBlocks& blocks = *blocks_;
  const std::vector<WallSample> samples = wallSamples(solid, normals, most, progress);
  std::vector<int> reach(blocks.count(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.count(), 16), [&](const auto& range) {
    for (std::size_t leaf = range.begin(); leaf < range.end(); ++leaf) {
      const SamplesAround around(blocks, samples, leaf);
      if (around.hasSamples()) reach[leaf] = setWays(blocks, around, leaf, ways_);
    }
  });
  throwIfCancelled(progress);
  if (!reach.empty()) reach_ = *std::max_element(reach.begin(), reach.end());
}

WallMiddles::WallMiddles(std::shared_ptr<const LeafBlocks> blocks, std::vector<std::int16_t> ways)
    : blocks_(std::move(blocks)), ways_(std::move(ways)) {
  for (const std::int16_t way : ways_) reach_ = std::max(reach_, std::abs(int{way}));
}

// While it waits for other threads, this one takes up no task that could ask for the walls too.
std::span<const glm::dmat3> SolidWalls::normals() {
  const std::lock_guard lock(found_);
  if (!normals_) tbb::this_task_arena::isolate([&] { normals_ = wallNormals(solid_); });
  return *normals_;
}

std::shared_ptr<const WallMiddles> SolidWalls::middles(const Progress* progress) {
  const std::span<const glm::dmat3> normals = this->normals();
  const std::lock_guard lock(found_);
  if (!middles_) {
    tbb::this_task_arena::isolate([&] {
      middles_ = std::make_shared<const WallMiddles>(solid_, normals, WallMiddles::mostOf(solid_),
                                                     progress);
    });
  }
  return middles_;
}

WaysAround::WaysAround(const WallMiddles* walls, const openvdb::Coord& origin)
    : walls_(walls), low_(origin.offsetBy(-8)) {
  leaf_.fill(LeafBlocks::kNone);
  for (int k = 0; k < 27 && walls_ != nullptr; ++k) {
    leaf_[static_cast<std::size_t>(k)] =
        findLeaf(walls_->blocks(), low_.offsetBy(8 * (k / 9), 8 * (k / 3 % 3), 8 * (k % 3)));
  }
}

glm::i64vec3 WaysAround::middleAt(const openvdb::Coord& voxel) const {
  glm::i64vec3 at(voxel.x(), voxel.y(), voxel.z());
  at *= WallMiddles::kSteps;
  if (walls_ == nullptr) return at;
  const openvdb::Coord from = voxel - low_;
  const auto k =
      static_cast<std::size_t>(9 * (from.x() >> 3) + 3 * (from.y() >> 3) + (from.z() >> 3));
  if (leaf_[k] == LeafBlocks::kNone) return at;
  const auto offset =
      static_cast<std::size_t>((from.x() & 7) << 6 | (from.y() & 7) << 3 | (from.z() & 7));
  return at + glm::i64vec3(walls_->wayAt(std::size_t{leaf_[k]} * 512 + offset));
}

}  // namespace sherd
