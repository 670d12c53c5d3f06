// Faces that would cross after an edge collapse.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "remesh/decimate/edge_collapse.h"

namespace sherd {

/// Returns whether a collapse makes faces cross each other or those around them, decided exactly.
///   at      [vertices]
///   a, b    the edge
///   target  where it collapses to
[[nodiscard]] bool fanCrosses(const CollapsingMesh& mesh, std::span<const glm::dvec3> at,
                              CollapsingMesh::Index a, CollapsingMesh::Index b,
                              const glm::dvec3& target);

}  // namespace sherd
