// Where seeds are drawn: uniformly, by Halton's points, about the middle, or well apart.
#pragma once

#include <sherd/seeds.h>

#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "seed/voxel_index.h"

namespace sherd {

/// Voxels chosen so far, in order, each once.
struct Chosen {
  std::vector<VoxelKey> voxels;
  std::unordered_set<VoxelKey> taken;

  std::size_t size() const { return voxels.size(); }

  /// Choose a voxel; false when it was already.
  bool add(VoxelKey key) {
    if (!taken.insert(key).second) return false;
    voxels.push_back(key);
    return true;
  }
};

/// A random candidate of each part.
///   inPart  [parts] candidates in each part, all above 0
[[nodiscard]] std::vector<VoxelKey> onePerPart(const VoxelIndex& candidates, const Parts& parts,
                                               std::span<const std::uint64_t> inPart,
                                               std::uint64_t seed);

/// Draws seeds by one sampler.  A further call goes on in its sequence where the last one stopped.
class SeedSampler {
 public:
  /// candidates  where seeds may lie; kept by reference
  /// box         tight box of the solid
  SeedSampler(const VoxelIndex& candidates, const VoxelBox& box, Sampler sampler,
              std::uint64_t seed)
      : candidates_(candidates), box_(box), sampler_(sampler), seed_(seed) {}

  /// Add `count` voxels; as many must be free.
  void draw(std::size_t count, Chosen& chosen);

 private:
  void drawHalton(std::size_t end, Chosen& chosen);
  void drawGaussian(std::size_t end, Chosen& chosen);
  void drawUniform(std::size_t end, Chosen& chosen);
  std::uint64_t tries(std::size_t count) const;

  const VoxelIndex& candidates_;
  VoxelBox box_;
  Sampler sampler_;
  std::uint64_t seed_;
  std::uint64_t next_ = 0;         // item of the sampler's next draw
  std::uint64_t nextUniform_ = 0;  // item of the next draw over all candidates
};

}  // namespace sherd
