// How well the two sides of cracks fit.
#pragma once

#include <sherd/evaluate.h>

#include <optional>
#include <span>
#include <vector>

#include "evaluate/cracks/contact_graph.h"
#include "evaluate/cracks/fragment_shape.h"

namespace sherd {

/// What gaps are measured on.
struct JointInput {
  std::span<const DividedMesh> meshes;
  std::span<const int> ids;  ///< [meshes]
  const ContactGraph& graph;
  double spacing = 0.0;    ///< of points and of heights, world units
  double tolerance = 0.0;  ///< FitOptions::tolerance
  bool knownNeighbors = false;
};

/// Measures the gaps between neighbors, and the difference of their surfaces.  Nothing without
/// contacts.
///   throws  Error(cancelled)
[[nodiscard]] std::optional<JointStatistics> jointsOf(const JointInput& input,
                                                      const Progress* progress);

}  // namespace sherd
