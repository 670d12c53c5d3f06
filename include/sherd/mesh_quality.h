// Mesh quality: statistics of edges, vertices, triangles and angles.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <cstddef>

namespace sherd {

/// Statistics of a mesh.  Edges of triangles with two equal corners are not counted.
struct MeshQuality {
  /// Bins of MeshQuality::smallestAngles: 5 degrees each, 0..60; 60 is in the last.
  static constexpr std::size_t kAngleBins = 12;

  std::size_t vertices = 0;  ///< used by a triangle
  std::size_t triangles = 0;
  std::size_t components = 0;  ///< connected by shared vertices

  // Each edge is counted at most once.
  std::size_t boundaryEdges = 0;        ///< of one triangle: the mesh is open there
  std::size_t nonManifoldEdges = 0;     ///< of three or more triangles
  std::size_t flippedEdges = 0;         ///< of two triangles with opposite orientation
  std::size_t nonManifoldVertices = 0;  ///< with more than one fan of triangles

  std::size_t degenerateTriangles = 0;  ///< area 0 in double precision
  std::size_t duplicateTriangles = 0;   ///< with the corners of an earlier one, in any order

  double smallestAngle = 0.0;      ///< degrees, of all corners; 0..60
  double meanSmallestAngle = 0.0;  ///< degrees, mean over the triangles of their smallest angle
  double sliverShare = 0.0;        ///< share of triangles with an angle below 10 degrees
  std::array<std::size_t, kAngleBins> smallestAngles{};  ///< triangles by their smallest angle

  double volume = 0.0;  ///< by the divergence theorem; valid if the mesh is closed

  /// No boundary edges, and every edge is used equally often in both directions (touching sheets
  /// included), so the mesh has an inside and a volume.
  bool closed = false;
  /// Every edge has two triangles of equal orientation, and every vertex one fan.
  bool manifold() const {
    return boundaryEdges + nonManifoldEdges + flippedEdges + nonManifoldVertices == 0;
  }
  /// Closed with a positive volume.
  bool outward() const { return closed && volume > 0.0; }
};

/// Measures a mesh.
///   mesh  any, also without triangles
///   cost  triangles * log triangles
[[nodiscard]] MeshQuality meshQuality(const TriangleMesh& mesh);

}  // namespace sherd
