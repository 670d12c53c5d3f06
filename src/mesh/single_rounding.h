// What single precision loses of positions.
#pragma once

#include <sherd/mesh.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sherd {

/// Returns how far single precision moves a point of a box at most along an axis.
[[nodiscard]] inline double singleRounding(const Box& box) {
  double farthest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    farthest = std::max({farthest, std::abs(box.min[axis]), std::abs(box.max[axis])});
  }
  if (!(farthest < std::numeric_limits<float>::max())) return farthest;  // no float comes near
  const auto most = static_cast<float>(farthest);
  const float next = std::nextafter(most, std::numeric_limits<float>::infinity());
  return (static_cast<double>(next) - static_cast<double>(most)) / 2.0;
}

}  // namespace sherd
