// What shares of growths are meant and kept.
#pragma once

#include <sherd/error.h>
#include <sherd/labels.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// Options of growWithShares.
struct SharedGrowthOptions {
  GrowOptions grow{};
  ShareOptions shares{};
  std::uint64_t seed = 0;                 ///< of new seeds
  const DensityField* density = nullptr;  ///< of new seeds, in their fragments
};

/// Checks that fragments can have the least share.
///   throws  Error(usage)
void checkShares(const ShareOptions& options, const VoxelComponents& components, int fragments,
                 std::uint64_t voxels);

/// Returns the least voxels of a fragment that growths are repeated for; 0: none.
[[nodiscard]] std::uint64_t leastVoxels(const ShareOptions& options, std::uint64_t voxels);

/// Returns the least share that is drawn or meant: that of the options, above it by what fragments
/// miss theirs, and some voxels.
///   above  the factor
[[nodiscard]] double leastShareOf(const ShareOptions& options, double above, std::size_t fragments,
                                  std::uint64_t voxels);

/// Returns the error where the least share was not reached within ShareOptions::tries.
[[nodiscard]] Error unreachedShare(const ShareOptions& options, int fragments,
                                   std::uint64_t smallest, std::uint64_t voxels, bool splits);

/// Moves each primary seed to its fragment's centroid, into the nearest voxel of the fragment.
/// Additional seeds of a fragment stay.
[[nodiscard]] std::vector<Seed> centeredSeeds(const Labels& labels, std::vector<Seed> seeds);

}  // namespace sherd
