// Charts as SVG.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace sherd::chart {

/// One row of a histogram chart.
struct HistogramRow {
  std::string name;
  std::vector<float> values;
};

struct HistogramOptions {
  std::string title;
  double high = 1.0;            ///< bins span 0..high; the last one also counts larger values
  std::vector<double> lines{};  ///< values to mark by vertical lines
  std::function<std::string(double)> label;  ///< formats a value
};

/// Draws one histogram per row, each scaled to its fullest bin.
[[nodiscard]] std::string histograms(const std::vector<HistogramRow>& rows,
                                     const HistogramOptions& options);

/// Draws labeled horizontal bars, largest first.
[[nodiscard]] std::string bars(const std::vector<std::pair<std::string, double>>& values,
                               const std::string& title,
                               const std::function<std::string(double)>& label);

/// Draws values over time.
///   seconds  [n] ascending
///   values   [n]
[[nodiscard]] std::string timeLine(const std::vector<double>& seconds,
                                   const std::vector<double>& values, const std::string& title,
                                   const std::function<std::string(double)>& label);

}  // namespace sherd::chart
