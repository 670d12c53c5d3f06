// How large fragments become: no small ones, and all about equal.
#pragma once

#include <sherd/labels.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

struct ShareOptions {
  double minShare = 0.0;  ///< least share of the solid's voxels that a fragment may have, 0..1
  int balance = 0;  ///< Lloyd steps before that: seeds move to their fragment's centre, 0..100
  int tries = 64;   ///< growths that may be spent on minShare

  bool isAny() const { return minShare != 0.0 || balance != 0; }  ///< is anything asked for?
};

/// Seeds and what grew from them.
struct SeededLabels {
  std::vector<Seed> seeds;
  Labels labels;
};

/// Grow, and grow again until fragments are as large as asked.  A fragment below minShare loses its
/// seeds, so that its neighbours take its place, and its id gets a new seed in the fragment that is
/// the largest by then; from the eighth growth on every seed also takes a Lloyd step.
///   seeds   as placeSeeds returns them
///   throws  Error(usage) minShare cannot be had: more than 1 / fragments, a part of the solid
///           below it, or not within `tries`; what grow throws
///   source  Lloyd, Least squares quantization in PCM, 1982 (the steps on centres)
[[nodiscard]] SeededLabels growWithShares(const LeafBlocks& blocks, const Parts& parts,
                                          std::vector<Seed> seeds, Device& device,
                                          const GrowOptions& grow, const ShareOptions& shares,
                                          std::uint64_t seed, const Progress* progress = nullptr);

}  // namespace sherd
