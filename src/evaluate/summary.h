// Summary statistics of distances.
#pragma once

#include <sherd/evaluate.h>

#include <optional>
#include <vector>

namespace sherd {

/// A distance and its weight.
struct WeightedDistance {
  double distance = 0.0;
  double weight = 1.0;  ///< > 0
};

/// Returns the weighted mean, 99th percentile and maximum; nullopt for no distances.
[[nodiscard]] std::optional<DistanceSummary> summaryOf(std::vector<WeightedDistance> distances);

}  // namespace sherd
