// Panels of a plot: a frame with a vertical axis, and columns in it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>

#include "chart/axis.h"
#include "chart/svg.h"

namespace sherd::chart {

inline constexpr double kTop = 104, kBottom = 300;  // of every panel

/// A panel and the range of its vertical axis.
struct Panel {
  double left, right;
  double low, high;  ///< values at the bottom and the top

  double y(double value) const {
    const double share = (std::clamp(value, low, high) - low) / (high - low);
    return kBottom - share * (kBottom - kTop);
  }
};

inline void drawFrame(Svg& svg, const Panel& panel, const std::string& title,
                      const std::string& below, const std::function<std::string(double)>& label) {
  svg.text(panel.left, kTop - 18, title, 13, kInk, Svg::Anchor::start, true);
  const double step = niceStep(panel.high - panel.low);
  for (double value = std::ceil(panel.low / step - 1e-9) * step + 0.0;  // not -0
       value <= panel.high + 1e-9 * step; value += step) {
    svg.line(panel.left, panel.y(value), panel.right, panel.y(value), kRule);
    svg.text(panel.left - 6, panel.y(value) + 4, label(value), 11, kGray, Svg::Anchor::end);
  }
  svg.text((panel.left + panel.right) / 2, kBottom + 38, below, 11, kGray, Svg::Anchor::middle);
}

/// Horizontal extent of a column.
struct Column {
  double left, width;
  double middle() const { return left + width / 2; }
};

inline Column column(const Panel& panel, std::size_t i, std::size_t count) {
  const double pitch = (panel.right - panel.left) / static_cast<double>(count);
  const double gap = std::min(6.0, 0.2 * pitch);
  return {panel.left + pitch * static_cast<double>(i) + gap / 2, pitch - gap};
}

}  // namespace sherd::chart
