// The parts of a mesh that open surfaces cut.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace sherd {

/// Triangles that cut a mesh: crack surfaces, of which several may share an edge.
struct Cutters {
  std::vector<glm::dvec3> vertices;   ///< [n] finite
  std::vector<glm::uvec3> triangles;  ///< [m] indices below n
};

/// A part of a triangle, oriented like it.
struct CutTriangle {
  glm::uvec3 corner{0};
  std::uint32_t source = 0;  ///< index of the whole triangle
};

/// The segment in which a triangle `s` of the surface and `c` of the cutters cross.  It is directed
/// along cross(normal of s, normal of c):
///
///        s seen from its front           c seen from its front
///                to                              to
///       behind c | in front of c     in front of s | behind s
///              from                            from
struct Seam {
  std::uint32_t from = 0, to = 0;  ///< vertices
  std::uint32_t s = 0, c = 0;

  /// On which side of c, of the surface's parts at the seam, the one to the left of from -> to is,
  /// and the same for the cutter's parts and s.
  static constexpr bool leftInSurfaceIsFront = false;
  static constexpr bool leftInCutterIsFront = true;
};

/// The parts of a surface and of its cutters.  Vertices are numbered: the surface's, then the
/// cutters', then `points`.
struct MeshCut {
  std::vector<glm::dvec3> points;             ///< the exact crossing points, rounded to nearest
  std::vector<CutTriangle> surface, cutters;  ///< parts of the crossed triangles, by source
  std::vector<std::uint8_t> surfaceCrossed;   ///< [triangles] 0 or 1
  std::vector<std::uint8_t> cutterCrossed;    ///< [triangles] 0 or 1
  std::vector<Seam> seams;                    ///< by s, then by c

  // What prevents the cut, ascending without repetition.  If one is not empty, the members above
  // are not complete.
  /// Cutters' vertices in degenerate position, which the caller is to move.
  std::vector<std::uint32_t> degenerate;
  std::vector<std::uint32_t> flat;  ///< crossed triangles of the surface without area
  /// Triangles of the surface that cross each other, on a cutter.
  std::vector<std::array<std::uint32_t, 2>> surfaceCrossings;
  /// Cutters that cross each other, on the surface.
  std::vector<std::array<std::uint32_t, 2>> cutterCrossings;

  [[nodiscard]] bool isComplete() const {
    return degenerate.empty() && flat.empty() && surfaceCrossings.empty() &&
           cutterCrossings.empty();
  }
};

}  // namespace sherd
