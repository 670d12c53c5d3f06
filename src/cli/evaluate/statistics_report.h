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

/// Returns the name of a rule, as `--faces` takes it.
[[nodiscard]] inline const char* nameOf(FaceRule rule) {
  switch (rule) {
    case FaceRule::planes:
      return "planes";
    case FaceRule::neighbors:
      return "neighbors";
    case FaceRule::splits:
      return "splits";
    case FaceRule::facets:
      break;
  }
  return "facets";
}

}  // namespace sherd::cli
