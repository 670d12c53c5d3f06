// Figures that tell of a finished fracture.
#pragma once

#include <sherd/mesh.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace sherd {

/// How convex a body is, measured at points of its surface.
struct Convexity {
  double value = 0.0;  ///< 1 - mean distance; below 1, and may be below 0
  double standardDeviation =
      0.0;                  ///< of the distances; / sqrt(samples): the value's standard error
  std::size_t samples = 0;  ///< points that were kept, <= the points asked for
};

/// One minus the mean distance from the surface, along its normal, to the convex hull.
///
/// The body is moved so that the mean of its vertices is the origin, and divided by its largest
/// absolute coordinate; no further size enters.  Points are uniform over the surface.  A point's
/// normal is interpolated from those of its triangle's vertices, which are means over the faces
/// round them, weighted by angle.  Each point is pushed inwards by 1e-4 of the diagonal of all
/// points' box, and dropped when it is then outside.  The distance runs from the pushed point, so a
/// convex body has 1 - 1e-4 * diagonal, some 0.9997.
///   mesh     closed, oriented outwards, every vertex used; equal vertices merged, or a fold stays
///   a
///            fold (readMesh merges)
///   samples  points to draw, >= 1
///   seed     of the points; the same gives the same value on any number of threads
///   cost     samples * (facets of the hull + log triangles)
///   throws   Error(usage) no samples; Error(input) no area, flat, or no point inside
///   source   Lopez et al., Generating implicit object fragment datasets for machine learning,
///            Computers & Graphics 2024, Figure 14, as its code computes it
[[nodiscard]] Convexity convexity(const TriangleMesh& mesh, std::size_t samples = 5000,
                                  std::uint64_t seed = 0);

/// How many pieces of equal size would be as evenly broken: (sum of shares)^2 / sum of share^2.
/// n for n equal shares, near 1 when one piece holds nearly all; 0 when no share is above 0.
///   source  the inverse of Simpson's index; Laakso and Taagepera, 1979
[[nodiscard]] double effectiveCount(std::span<const double> shares);

}  // namespace sherd
