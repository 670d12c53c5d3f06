// The nearly planar regions of a crack surface.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "surface/crack_surface.h"
#include "surface/face_edges.h"

namespace sherd {

/// Regions of connected faces between the same two labels, near one plane each.
struct Facets {
  struct Plane {
    glm::dvec3 point{0.0};
    glm::dvec3 normal{0.0};  ///< unit, that of the faces
  };
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<std::uint32_t> ofFace;  ///< [faces] kNone: a face that stays one
  std::vector<Plane> planes;          ///< [facets]
  std::vector<std::size_t> sizes;     ///< [facets] faces that the plane was fitted to
};

/// Grows regions from face to face, in the order of faces, while their corners are within a
/// distance of the plane of the faces so far.  A region of a few faces is part of a larger one
/// beside it, or of none.
///   tolerance  world units
[[nodiscard]] Facets facetsOf(const CrackSurface& cracks, const FaceEdges& edges, double tolerance);

/// Moves vertices on the borders of facets to their common point or line, so that borders are
/// straight.  A vertex that would move by more than `most`, because its planes are nearly parallel,
/// stays, and so does one of a face that is of no facet.
///   return  the positions of all vertices
[[nodiscard]] std::vector<glm::dvec3> snapped(const CrackSurface& cracks, const Facets& facets,
                                              double most);

/// Takes each face for which a condition holds out of its facet.
void splitOff(Facets& facets, const std::function<bool(std::size_t)>& condition);

}  // namespace sherd
