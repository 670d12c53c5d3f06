// Labels, and a seed of each fragment.
#pragma once

#include <sherd/labels.h>

#include <vector>

namespace sherd {

/// Seeds and the labels grown from them.
struct SeededLabels {
  std::vector<Seed> seeds;
  Labels labels;
};

}  // namespace sherd
