// Exact positions in homogeneous coordinates.
#pragma once

#include <array>
#include <glm/vec3.hpp>

#include "intersect/dyadic.h"
#include "intersect/exact_point.h"

namespace sherd {

/// The coordinates of a point, multiplied by `weight`, which is not zero.
struct HomogeneousPoint {
  std::array<Dyadic, 3> at;
  Dyadic weight;
};

[[nodiscard]] HomogeneousPoint positionOf(const ExactPoint& p);

/// Sets the rounded coordinate along an axis, with its rest and error.
void roundAlong(const HomogeneousPoint& exact, int axis, ExactPoint& p);

/// Returns the sign of p - q along an axis, exactly.
[[nodiscard]] int compare(const ExactPoint& p, const ExactPoint& q, int axis);

/// Returns whether two points are at one position, exactly.
[[nodiscard]] bool areEqual(const ExactPoint& p, const ExactPoint& q);

/// Returns 1 if a point is in front of a triangle, -1 behind it, 0 in its plane; exact.
[[nodiscard]] int orientation(const std::array<glm::dvec3, 3>& triangle, const ExactPoint& p);

/// Returns the point where two lines of one plane cross.
///   p, q  two points of each line; the lines differ when projected along `axis`, 0..2
[[nodiscard]] ExactPoint lineCrossing(const std::array<ExactPoint, 2>& p,
                                      const std::array<ExactPoint, 2>& q, int axis);

/// Returns the mean of three points.
///   weights  positive
[[nodiscard]] ExactPoint weightedMean(const std::array<ExactPoint, 3>& points,
                                      const std::array<int, 3>& weights);

}  // namespace sherd
