// Colors and axis ticks of charts.
#pragma once

#include <cmath>

namespace sherd::chart {

// Okabe and Ito's palette, which is safe for color-blind readers.
inline constexpr const char* kBlue = "#0072b2";
inline constexpr const char* kOrange = "#d55e00";
inline constexpr const char* kGreen = "#009e73";
inline constexpr const char* kInk = "#222222";
inline constexpr const char* kGray = "#777777";
inline constexpr const char* kRule = "#dddddd";

/// Returns the distance of ticks: 1, 2 or 5 times a power of ten, four to eight in `range`.
///   range  > 0
inline double niceStep(double range) {
  const double rough = range / 5.0, power = std::pow(10.0, std::floor(std::log10(rough)));
  const double lead = rough / power;
  return power * (lead < 1.5 ? 1.0 : lead < 3.5 ? 2.0 : lead < 7.5 ? 5.0 : 10.0);
}

}  // namespace sherd::chart
