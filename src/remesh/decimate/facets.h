// The nearly planar regions of a complex.
#pragma once

#include <sherd/progress.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "remesh/complex.h"
#include "remesh/face_edges.h"

namespace sherd {

/// When faces are one facet.
struct FacetKind {
  double tolerance =
      0.0;               ///< distance of corners from the facet's plane, world units; 0: no facets
  double ofSmall = 4.0;  ///< factor on it where a larger facet absorbs some faces beside it
  std::size_t leastFaces = 64;    ///< of a facet.  On curved surfaces polygons of a few faces save
                                  ///< little, and would cross each other
  std::size_t planarFaces = 128;  ///< facets of fewer are parts of curved surfaces: borders are not
                                  ///< moved onto them
};

struct FacetOptions {
  FacetKind cracks{};    ///< faces between two fragments, or eroded ones
  FacetKind original{};  ///< faces whose back is 0, and all of a mesh alone

  [[nodiscard]] const FacetKind& of(const ComplexFace& face) const {
    return face.back == 0 ? original : cracks;
  }
};

/// Regions of connected faces between the same two labels, with the same neighbor and chart, near
/// one plane each.
struct Facets {
  struct Plane {
    glm::dvec3 point{0.0};
    glm::dvec3 normal{0.0};  ///< unit, that of the faces
  };
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<std::uint32_t> ofFace;  ///< [faces] kNone: a face that stays one
  std::vector<Plane> planes;          ///< [facets]
  std::vector<double> tolerances;     ///< [facets] FacetKind::tolerance
  std::vector<bool> isPlanar;         ///< [facets] borders are moved onto them
};

/// Grows regions from face to face, in the order of faces, while their corners are within a
/// distance of the plane of the faces so far.  A region of a few faces is part of a larger one
/// beside it, or of none.  Faces at fixed vertices are of none.
///   edges   of the complex's faces
///   throws  Error(cancelled)
[[nodiscard]] Facets facetsOf(const LabeledComplex& complex, const FaceEdges& edges,
                              const FacetOptions& options, const Progress* progress = nullptr);

/// Moves vertices on the borders of facets to their common point or line, so that borders are
/// straight.  A vertex that would move by more than `most`, because its planes are nearly parallel,
/// stays, and so does one of a face that is of no facet.
///   return  the positions of all vertices
[[nodiscard]] std::vector<glm::dvec3> snapped(const LabeledComplex& complex, const Facets& facets,
                                              double most);

}  // namespace sherd
