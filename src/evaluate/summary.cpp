// Summary statistics of distances.
#include "evaluate/summary.h"

#include <algorithm>
#include <tuple>

namespace sherd {

std::optional<DistanceSummary> summaryOf(std::vector<WeightedDistance> distances) {
  if (distances.empty()) return {};
  std::sort(distances.begin(), distances.end(),
            [](const WeightedDistance& a, const WeightedDistance& b) {
              return std::tie(a.distance, a.weight) < std::tie(b.distance, b.weight);
            });
  double sum = 0.0, weights = 0.0;
  for (const WeightedDistance& d : distances) {
    sum += d.distance * d.weight;
    weights += d.weight;
  }
  DistanceSummary summary{distances.size(), sum / weights, distances.back().distance,
                          distances.back().distance};
  double below = 0.0;
  for (const WeightedDistance& d : distances) {
    below += d.weight;
    if (below < 0.99 * weights) continue;
    summary.p99 = d.distance;
    break;
  }
  return summary;
}

}  // namespace sherd
