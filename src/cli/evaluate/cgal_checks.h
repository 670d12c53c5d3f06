// Independent mesh checks by CGAL.  See docs/decisions/0005-licenses.md.
#pragma once

#include <sherd/evaluate.h>
#include <sherd/mesh.h>

#include <cstddef>
#include <cstdint>
#include <optional>

namespace sherd {

/// Results of CGAL's checks.  Checks whose precondition fails are absent or false.
struct CgalVerdict {
  bool polygonMesh = false;  ///< is_polygon_soup_a_polygon_mesh: every edge and vertex manifold,
                             ///< faces that share an edge oriented alike
  bool valid = false;        ///< is_valid_polygon_mesh; false without polygonMesh
  bool closed = false;       ///< is_closed; false without polygonMesh
  std::optional<std::size_t>
      selfIntersections;  ///< pairs of triangles that cross; absent without polygonMesh
  bool boundsVolume =
      false;  ///< does_bound_a_volume; false where the mesh is open or intersects itself
  std::optional<Convexity> convexity;  ///< as convexity(), from the same points, by CGAL's hull,
                                       ///< AABB tree and inside test; absent for an open mesh
};

/// Returns whether this build links CGAL's GPL packages (SHERD_GPL=ON).
[[nodiscard]] bool hasCgalChecks();

/// Returns the license of this build's program: "GPL-3.0-or-later" where it links these packages,
/// else "Apache-2.0".
[[nodiscard]] inline const char* programLicense() {
  return hasCgalChecks() ? "GPL-3.0-or-later" : "Apache-2.0";
}

/// Checks a mesh with CGAL.
///   mesh     oriented outwards, if closed
///   samples  points for the convexity, >= 1; `seed` is theirs
///   throws   Error(internal) this build has no CGAL checks, or CGAL failed
[[nodiscard]] CgalVerdict checkWithCgal(const TriangleMesh& mesh, std::size_t samples,
                                        std::uint64_t seed);

}  // namespace sherd
