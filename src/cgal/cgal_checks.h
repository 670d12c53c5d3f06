// What CGAL, a library that is not ours, says of a mesh.  See docs/decisions/0005-licences.md.
#pragma once

#include <sherd/evaluate.h>
#include <sherd/mesh.h>

#include <cstddef>
#include <cstdint>
#include <optional>

namespace sherd {

/// CGAL's verdict.  What needs more than the mesh has is absent.
struct CgalVerdict {
  bool polygonMesh = false;  ///< is_polygon_soup_a_polygon_mesh: every edge and vertex manifold,
                             ///< faces that share an edge oriented alike
  bool valid = false;        ///< is_valid_polygon_mesh; false where it is no polygon mesh
  bool closed = false;       ///< is_closed; false where it is no polygon mesh
  std::optional<std::size_t>
      selfIntersections;  ///< pairs of triangles that cross, of a polygon mesh
  bool boundsVolume =
      false;  ///< does_bound_a_volume; false where it is not closed, or intersects itself
  std::optional<Convexity> convexity;  ///< that of convexity(), from the same points, by CGAL's
                                       ///< hull, its AABB tree and its test for inside; of a mesh
                                       ///< that is closed and does not intersect itself
};

/// Whether this build links CGAL's packages under the GPL (SHERD_GPL=ON).
[[nodiscard]] bool hasCgalChecks();

/// The license that the program of this build is distributed under: "GPL-3.0-or-later" where it
/// links these packages, else "Apache-2.0".
[[nodiscard]] inline const char* programLicense() {
  return hasCgalChecks() ? "GPL-3.0-or-later" : "Apache-2.0";
}

/// Ask CGAL.
///   mesh    oriented outwards, if closed
///   throws  Error(internal) this build has no checks by CGAL
[[nodiscard]] CgalVerdict askCgal(const TriangleMesh& mesh, std::size_t samples,
                                  std::uint64_t seed);

}  // namespace sherd
