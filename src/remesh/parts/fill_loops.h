// Triangles that fill loops of edges.
#pragma once

#include <sherd/progress.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <utility>
#include <vector>

namespace sherd {

/// The edges of a mesh that filling triangles had better not use again, lower vertex first, sorted.
using KnownEdges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

struct FilledLoops {
  std::vector<glm::uvec3> triangles;  ///< numbers of vertices, those of `centers` after the given
  std::vector<glm::dvec3> centers;    ///< vertices of cones
};

/// Fills loops: the triangles use each edge of a loop once in its direction, more often than in the
/// other one by as many loops as have it, and every other edge equally often in both directions.
///
/// Loops that are nearly planar are filled by a constrained Delaunay triangulation, seen along the
/// axis that is nearest to their normal; loops in one plane together, so that the area between a
/// loop and one around it that runs the other way is a ring.  Other loops are filled with the least
/// area, those of many vertices by a triangulation along the axis or a cone.
///   vertices  at different positions
///   loops     of 3 or more different vertices each
///   edges     of the mesh between the loops' vertices
///   cost      vertices * log(vertices) of planar loops, vertices^3 of others to kMostForLeastArea
///   throws    Error(cancelled)
///   source    Barequet, Sharir, Filling gaps in the boundary of a polyhedron, 1995 (least area)
[[nodiscard]] FilledLoops filledLoops(std::span<const glm::dvec3> vertices,
                                      std::span<const std::vector<std::uint32_t>> loops,
                                      const KnownEdges& edges, const Progress* progress);

/// The most vertices of a loop that is filled with the least area.
inline constexpr std::size_t kMostForLeastArea = 256;

}  // namespace sherd
