// What of the mesh that was cut a vertex lies on.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "clean/stars.h"

namespace sherd {

/// Triangles of the mesh, ascending: none of a vertex within a crack, one of a vertex within a
/// triangle, those at an edge, and those around a vertex of the mesh.
using Carrier = std::vector<std::uint32_t>;

/// Returns the triangles of which some faces are parts: those around a vertex, or at an edge.
[[nodiscard]] Carrier carrierOf(const Stars& stars, std::span<const std::uint32_t> faces);

/// Returns whether a vertex that lies on `own` lies on `other` where it lies on all of it.
[[nodiscard]] bool liesOn(const Carrier& own, const Carrier& other);

/// Returns unit vectors along which a vertex may move, opposite ones of equal number.
[[nodiscard]] std::vector<glm::dvec3> waysAlong(const Carrier& carrier, const TriangleMesh& mesh);

}  // namespace sherd
