// The result of `sherd evaluate --statistics`, and its output formats.
#pragma once

#include <sherd/evaluate.h>

#include <string>

namespace sherd::cli {

struct StatisticsReport {
  std::string folder;  ///< as given
  FragmentSet set;     ///< its meshes are not used by the reports
  FractureStatistics statistics;
};

[[nodiscard]] std::string statisticsJson(const StatisticsReport& report);
[[nodiscard]] std::string statisticsTable(const StatisticsReport& report);
[[nodiscard]] std::string statisticsCsv(
    const StatisticsReport& report);  ///< a row for each fragment

/// Returns the name of a rule: "planes", "neighbors" or "splits".
[[nodiscard]] inline const char* nameOf(FaceRule rule) {
  return rule == FaceRule::planes ? "planes" : rule == FaceRule::splits ? "splits" : "neighbors";
}

}  // namespace sherd::cli
