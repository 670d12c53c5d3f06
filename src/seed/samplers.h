// Seed samplers: uniform, Halton, Gaussian, Poisson-disk.
#pragma once

#include <sherd/seeds.h>

#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "seed/voxel_index.h"

namespace sherd {

/// The distinct voxels chosen so far, in order.
struct Chosen {
  std::vector<VoxelKey> voxels;
  std::unordered_set<VoxelKey> taken;

  std::size_t size() const { return voxels.size(); }

  /// Adds a voxel; returns false if it is already chosen.
  bool add(VoxelKey key) {
    if (!taken.insert(key).second) return false;
    voxels.push_back(key);
    return true;
  }
};

/// Returns a random candidate of each component.
///   inComponent  [components] candidates in each component, all above 0
[[nodiscard]] std::vector<VoxelKey> onePerComponent(const VoxelIndex& candidates,
                                                    const VoxelComponents& components,
                                                    std::span<const std::uint64_t> inComponent,
                                                    std::uint64_t seed);

/// Draws seeds with one sampler.  Each call continues the sequence of the previous one.
class SeedSampler {
 public:
  /// candidates  the voxels that seeds may take; kept by reference
  /// box         tight box of the solid
  SeedSampler(const VoxelIndex& candidates, const VoxelBox& box, Sampler sampler,
              std::uint64_t seed)
      : candidates_(candidates), box_(box), sampler_(sampler), seed_(seed) {}

  /// Adds `count` voxels; at least as many must be free.
  void draw(std::size_t count, Chosen& chosen);

 private:
  void drawHalton(std::size_t end, Chosen& chosen);
  void drawGaussian(std::size_t end, Chosen& chosen);
  void drawUniform(std::size_t end, Chosen& chosen);
  std::uint64_t maxTries(std::size_t count) const;

  const VoxelIndex& candidates_;
  VoxelBox box_;
  Sampler sampler_;
  std::uint64_t seed_;
  std::uint64_t next_ = 0;         // random item of the sampler's next draw
  std::uint64_t nextUniform_ = 0;  // random item of the next uniform draw
};

}  // namespace sherd
