// Coarser meshes for a page that has to stay small.
#pragma once

#include "viewer/scene.h"

namespace sherd {

/// Clusters the vertices of all pieces in one grid of cubes, so that neighbors stay joined and
/// closed meshes closed (as chains: sheets may touch).
class ClusteredVertices {
 public:
  ///   cubes  along the longest side of the box, at most kMostCubes
  ClusteredVertices(const std::vector<ViewerPiece>& pieces, const Box& box, int cubes);

  static constexpr int kMostCubes = 1024;

  struct Mesh {
    TriangleMesh mesh;
    SurfaceAttributes attributes;  ///< of the triangles that are left
  };

  /// Returns a piece's mesh with its vertices at the mean of their cubes; the piece's own if it is
  /// smaller than some cubes, of which nothing would be left.
  [[nodiscard]] Mesh of(const ViewerPiece& piece) const;

 private:
  [[nodiscard]] std::uint32_t cubeOf(const glm::dvec3& position) const;

  glm::dvec3 low_;
  double side_;                       ///< of a cube, world units
  std::vector<std::uint32_t> cubes_;  ///< ascending
  std::vector<glm::dvec3> means_;     ///< [cubes_]
};

}  // namespace sherd
