// Labels, and a seed of each fragment.
#pragma once

#include <sherd/labels.h>

#include <vector>

namespace sherd {

/// Seeds and the labels grown from them.
struct SeededLabels {
  std::vector<Seed> seeds;
  Labels labels;
  double sizeError = 0.0;             ///< as FractureResult::sizeError
  std::vector<double> meantShares{};  ///< [fragments] of growth by splits
};

}  // namespace sherd
