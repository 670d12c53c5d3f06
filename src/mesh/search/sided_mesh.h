// On which side of a mesh a point lies.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "mesh/search/triangle_tree.h"

namespace sherd {

/// The signed distance to a mesh, open or closed: positive on the side to which its triangles'
/// normals point.  Thread-safe.
///
/// The sign is that of the pseudonormal of the closest feature: of a vertex the mean of the normals
/// around it, weighted by angle, of an edge the mean of its two.  Beyond the border of an open mesh
/// the sign and the distance are those of the plane that continues the mesh there, so that space is
/// divided in two.
///   source  Baerentzen, Aanaes, Signed distance computation using the angle weighted pseudonormal,
///           2005
class SidedMesh {
 public:
  /// Results are the same for both; a strip of long thin triangles is faster as one.
  enum class Shape { any, strip };

  ///   mesh  oriented consistently; triangles without an area are dropped; one at least must be
  ///         left
  explicit SidedMesh(TriangleMesh mesh, Shape shape = Shape::any);

  /// Where a point lies.
  struct Side {
    double distance = 0.0;  ///< signed
    double toMesh = 0.0;    ///< to the closest point of the mesh
    std::uint32_t guess =
        TriangleTree::kNone;  ///< for points nearby: the closest triangle, in the tree's order
  };

  [[nodiscard]] Side sideOf(const glm::dvec3& point,
                            std::uint32_t guess = TriangleTree::kNone) const;

  [[nodiscard]] double signedDistance(const glm::dvec3& point) const {
    return sideOf(point).distance;
  }

  /// Returns whether all points within `reach` of a point are on its side: the mesh is farther
  /// away, and its border is not where the side is decided.
  ///   side  of the point
  [[nodiscard]] bool isOneSided(const glm::dvec3& point, const Side& side, double reach) const;

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  [[nodiscard]] bool isClosed() const { return border_.empty(); }

 private:
  TriangleMesh mesh_;
  TriangleTree tree_;
  TriangleTree border_;                                 // its edges, as triangles without area
  std::vector<glm::dvec3> faceNormals_;                 // [triangles] unit
  std::vector<glm::dvec3> vertexNormals_;               // [vertices] unit, or 0
  std::vector<std::array<glm::dvec3, 3>> edgeNormals_;  // [triangles] unit, or 0; of the edge from
                                                        // each corner to the next
  std::vector<bool> isBorderVertex_;                    // [vertices]
  std::vector<std::array<bool, 3>> isBorderEdge_;       // [triangles]
};

}  // namespace sherd
