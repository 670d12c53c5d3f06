// The convex hull of points, as half spaces and as a mesh.
#pragma once

#include <sherd/mesh.h>

#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// The half space dot(normal, p) + offset <= 0.
struct HalfSpace {
  glm::dvec3 normal{0.0};  ///< unit, outwards
  double offset = 0.0;
};

/// Returns the half spaces whose intersection is the hull, one per facet; facets that are coplanar
/// within rounding are merged.
///   throws  Error(input) the points lie in a plane
///   source  Barber, Dobkin, Huhdanpaa, The Quickhull algorithm for convex hulls, 1996 (Qhull)
[[nodiscard]] std::vector<HalfSpace> convexHull(std::vector<glm::dvec3> points);

/// Returns the hull as a mesh, oriented outwards; each facet is a fan of triangles.
///   inset   distance by which facets are moved inwards, limited to half of the least distance of a
///           facet from the points' mean, so that the result has volume
///   throws  as convexHull
[[nodiscard]] TriangleMesh convexHullMesh(std::vector<glm::dvec3> points, double inset = 0.0);

/// Returns where a ray from inside leaves the hull, in lengths of its direction, >= 0.
[[nodiscard]] double exitDistance(std::span<const HalfSpace> hull, const glm::dvec3& origin,
                                  const glm::dvec3& direction);

}  // namespace sherd
