// The convex hull of points, as half spaces and as a mesh.
#pragma once

#include <sherd/mesh.h>

#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// The hull's side of a plane: dot(normal, p) + offset <= 0.
struct HalfSpace {
  glm::dvec3 normal{0.0};  ///< unit, outwards
  double offset = 0.0;
};

/// The half spaces whose intersection is the hull, one per facet; facets that are flat to within
/// rounding are one.
///   throws  Error(input) the points lie in a plane
///   source  Barber, Dobkin, Huhdanpaa, The Quickhull algorithm for convex hulls, 1996 (Qhull)
[[nodiscard]] std::vector<HalfSpace> convexHull(std::vector<glm::dvec3> points);

/// The hull as a mesh, oriented outwards; facets that are flat to within rounding are fans.
///   inset   how far each facet is moved inwards; no farther than half of what its distance from
///           the points' mean allows, so that something is left
///   throws  as convexHull
[[nodiscard]] TriangleMesh convexHullMesh(std::vector<glm::dvec3> points, double inset = 0.0);

/// Where a ray from inside leaves the hull, in lengths of its direction: >= 0.
[[nodiscard]] double exitDistance(std::span<const HalfSpace> hull, const glm::dvec3& origin,
                                  const glm::dvec3& direction);

}  // namespace sherd
