// Points in the plane of a triangle.
#pragma once

#include <array>
#include <cstdint>

#include "intersect/crossing_point.h"

namespace sherd {

/// A point in a triangle.
struct TrianglePoint {
  ExactPoint point;
  std::uint8_t edges = 0;  ///< bit k: on the edge from corner k to the next
};

/// The bits of the corners.
inline constexpr std::array<std::uint8_t, 3> kCornerEdges{0b101, 0b011, 0b110};

}  // namespace sherd
