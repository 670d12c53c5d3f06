// Labels, and a seed of each fragment.
#pragma once

#include <sherd/labels.h>

#include <cstddef>
#include <vector>

namespace sherd {

/// Seeds and the labels grown from them.
struct SeededLabels {
  std::vector<Seed> seeds;
  Labels labels;
  double sizeError = 0.0;             ///< as FractureResult::sizeError
  std::vector<double> meantShares{};  ///< [fragments] of growth by splits
  std::vector<std::size_t> guided{};  ///< of growth by splits: for each split by a given crack, its
                                      ///< number
  std::vector<std::size_t> guide{};   ///< [given cracks] index of the guide that each is of
};

}  // namespace sherd
