// The rays that convexity() measures along; they start just below the surface.
#pragma once

#include <sherd/evaluate.h>

#include <span>
#include <vector>

namespace sherd {

struct ConvexityRays {
  struct Ray {
    glm::dvec3 origin{0.0};
    glm::dvec3 direction{0.0};  ///< unit
  };

  TriangleMesh mesh;      ///< origin at the mean of its vertices, largest absolute coordinate 1
  std::vector<Ray> rays;  ///< [<= samples], none where normals cancel; some origins lie outside
};

/// Samples the surface and returns a ray for each point.
///   throws  Error(usage) no samples; Error(input) no area
[[nodiscard]] ConvexityRays convexityRays(const TriangleMesh& mesh, std::size_t samples,
                                          std::uint64_t seed);

/// Returns the convexity from distances between interior points and the convex hull.
///   distances  [>= 1], of the normalized mesh; those below 0 are skipped
///   throws     Error(input) all are below 0
[[nodiscard]] Convexity convexityFrom(std::span<const double> distances);

}  // namespace sherd
