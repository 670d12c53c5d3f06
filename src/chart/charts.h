// Charts as SVG.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace sherd::chart {

/// One row of a chart: values that are counted into bins.
struct HistogramRow {
  std::string name;
  std::vector<float> values;
};

struct HistogramOptions {
  std::string title;
  double high = 1.0;            ///< the bins go from 0 to here, and values beyond into the last
  std::vector<double> lines{};  ///< values that are marked
  std::function<std::string(double)> label;  ///< of a value
};

/// Rows of bins one below the other, each as high as its fullest bin.
[[nodiscard]] std::string histograms(const std::vector<HistogramRow>& rows,
                                     const HistogramOptions& options);

/// Bars from the largest down, with what they stand for.
[[nodiscard]] std::string bars(const std::vector<std::pair<std::string, double>>& values,
                               const std::string& title,
                               const std::function<std::string(double)>& label);

/// A line over time.
[[nodiscard]] std::string timeLine(const std::vector<double>& seconds,
                                   const std::vector<double>& values, const std::string& title,
                                   const std::function<std::string(double)>& label);

}  // namespace sherd::chart
