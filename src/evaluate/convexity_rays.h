// What convexity() measures along: rays from below the surface.
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

  TriangleMesh body;      ///< about the mean of its vertices, its largest absolute coordinate 1
  std::vector<Ray> rays;  ///< [samples] less those whose normals cancel; some start outside
};

/// throws  Error(usage) no samples; Error(input) no area
[[nodiscard]] ConvexityRays convexityRays(const TriangleMesh& mesh, std::size_t samples,
                                          std::uint64_t seed);

/// Of the distances from points inside to the hull.
///   distances  [>= 1], those below 0 are left out
///   throws     Error(input) none is left
[[nodiscard]] Convexity convexityFrom(std::span<const double> distances);

}  // namespace sherd
