// Many distances in a few figures.
#pragma once

#include <sherd/fit.h>

#include <optional>
#include <vector>

namespace sherd {

/// A distance, and for how much it counts.
struct WeightedDistance {
  double distance = 0.0;
  double weight = 1.0;  ///< > 0
};

/// Their figures, or nothing for none.
[[nodiscard]] std::optional<DistanceSummary> summaryOf(std::vector<WeightedDistance> distances);

}  // namespace sherd
