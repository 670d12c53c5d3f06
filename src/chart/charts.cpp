// Histograms, bar charts and time lines.
#include "chart/charts.h"

#include <algorithm>

#include "base/text/formatted.h"
#include "chart/axis.h"
#include "chart/svg.h"

namespace sherd::chart {
namespace {

constexpr double kWidth = 380.0, kLeft = 64.0, kRight = 366.0, kChartTop = 44.0;
constexpr std::size_t kBins = 48;

double xOf(double value, double high) { return kLeft + (kRight - kLeft) * value / high; }

void drawTitle(Svg& svg, const std::string& title) {
  svg.text(kLeft, 16, title, 13, kInk, Svg::Anchor::start, true);
}

// Vertical grid lines, with values along the lower edge.
void drawScale(Svg& svg, double high, double bottom,
               const std::function<std::string(double)>& label) {
  const double each = niceStep(high);
  for (double value = 0.0; value <= high * (1.0 + 1e-9); value += each) {
    svg.line(xOf(value, high), kChartTop - 8, xOf(value, high), bottom, kRule);
    svg.text(xOf(value, high), bottom + 14, label(value), 10, kGray, Svg::Anchor::middle);
  }
}

}  // namespace

std::string histograms(const std::vector<HistogramRow>& rows, const HistogramOptions& options) {
  constexpr double kRow = 30.0;
  const double bottom = kChartTop + kRow * static_cast<double>(rows.size());
  Svg svg(kWidth, bottom + 24);
  drawTitle(svg, options.title);
  drawScale(svg, options.high, bottom, options.label);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::vector<std::size_t> bins(kBins);
    for (const float value : rows[r].values) {
      const double at = static_cast<double>(value) / options.high * kBins;
      ++bins[std::min(static_cast<std::size_t>(std::max(at, 0.0)), kBins - 1)];
    }
    const std::size_t maxCount =
        std::max<std::size_t>(*std::max_element(bins.begin(), bins.end()), 1);
    const double base = kChartTop + kRow * static_cast<double>(r + 1);
    const double width = (kRight - kLeft) / kBins;
    for (std::size_t i = 0; i < kBins; ++i) {
      if (bins[i] == 0) continue;
      const double height =
          (kRow - 6.0) * static_cast<double>(bins[i]) / static_cast<double>(maxCount);
      svg.rect(kLeft + width * static_cast<double>(i), base - height, width, height, kBlue);
    }
    svg.line(kLeft, base, kRight, base, kGray);
    svg.text(kLeft - 6, base - 4, rows[r].name, 10, kInk, Svg::Anchor::end);
  }
  double from = 0.0;  // right end of the previous label
  for (const double value : options.lines) {
    if (value >= options.high) continue;
    const double x = xOf(value, options.high);
    svg.line(x, kChartTop - 8, x, bottom, kOrange, /*dashed=*/true);
    const double words = std::max(x - 10.0, from);
    svg.text(words, kChartTop - 12, options.label(value), 9, kOrange);
    from = words + 40.0;
  }
  return svg.done();
}

std::string bars(const std::vector<std::pair<std::string, double>>& values,
                 const std::string& title, const std::function<std::string(double)>& label) {
  constexpr double kRow = 20.0;
  std::vector<std::pair<std::string, double>> sorted = values;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  const double maxValue = sorted.empty() ? 1.0 : std::max(sorted.front().second, 1e-12);
  Svg svg(kWidth, kChartTop + kRow * static_cast<double>(sorted.size()) + 8);
  drawTitle(svg, title);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const double top = kChartTop + kRow * static_cast<double>(i);
    const double width = 0.7 * (kRight - kLeft) * sorted[i].second / maxValue;
    svg.text(kLeft - 6, top + 11, sorted[i].first, 10, kInk, Svg::Anchor::end);
    svg.rect(kLeft, top, width, kRow - 6, kBlue);
    svg.text(kLeft + width + 6, top + 11, label(sorted[i].second), 10, kGray);
  }
  return svg.done();
}

std::string timeLine(const std::vector<double>& seconds, const std::vector<double>& values,
                     const std::string& title, const std::function<std::string(double)>& label) {
  constexpr double kChartBottom = kChartTop + 120.0;
  Svg svg(kWidth, kChartBottom + 24);
  drawTitle(svg, title);
  const std::size_t count = std::min(seconds.size(), values.size());
  if (count == 0) return svg.done();
  const double end = std::max(seconds[count - 1], 1e-9);
  const double high = std::max(*std::max_element(values.begin(), values.end()) * 1.05, 1e-9);
  const auto yOf = [&](double value) {
    return kChartBottom - (kChartBottom - kChartTop) * value / high;
  };
  drawScale(svg, end, kChartBottom, [](double value) { return formatted("%g s", value); });
  for (double value = 0.0; value <= high; value += niceStep(high)) {
    svg.line(kLeft, yOf(value), kRight, yOf(value), kRule);
    svg.text(kLeft - 6, yOf(value) + 4, label(value), 10, kGray, Svg::Anchor::end);
  }
  // About 300 segments at most, each the maximum of a run of samples.
  const std::size_t each = std::max<std::size_t>(count / 300, 1);
  double fromX = kLeft, fromY = yOf(values[0]);
  for (std::size_t i = 0; i < count; i += each) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(i);
    const auto last = values.begin() + static_cast<std::ptrdiff_t>(std::min(i + each, count));
    const double x = xOf(seconds[i], end), y = yOf(*std::max_element(first, last));
    svg.line(fromX, fromY, x, y, kBlue);
    fromX = x;
    fromY = y;
  }
  return svg.done();
}

}  // namespace sherd::chart
