// How sound a mesh is: its edges, vertices, triangles and angles.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <cstddef>

namespace sherd {

/// What is right and wrong with a mesh.  Edges of triangles with two equal corners do not count.
struct MeshQuality {
  /// Bins of MeshQuality::smallestAngles: 5 degrees each, 0..60; 60 is in the last.
  static constexpr std::size_t kAngleBins = 12;

  std::size_t vertices = 0;  ///< that a triangle uses
  std::size_t triangles = 0;
  std::size_t components = 0;  ///< connected over shared vertices

  // An edge is counted once at most.
  std::size_t boundaryEdges = 0;     ///< of one triangle: the mesh is open there
  std::size_t nonManifoldEdges = 0;  ///< of three triangles or more
  std::size_t flippedEdges = 0;      ///< of two triangles that face opposite sides
  std::size_t nonManifoldVertices =
      0;  ///< whose triangles do not hang together over edges: two fans that touch in a point

  std::size_t degenerateTriangles = 0;  ///< without area, as double precision can tell
  std::size_t duplicateTriangles = 0;   ///< with the corners of an earlier one, in any order

  double smallestAngle = 0.0;      ///< degrees, of all corners; 0..60
  double meanSmallestAngle = 0.0;  ///< degrees, mean over the triangles of their smallest angle
  double sliverShare = 0.0;        ///< of the triangles, whose smallest angle is under 10 degrees
  std::array<std::size_t, kAngleBins> smallestAngles{};  ///< triangles by their smallest angle

  double volume = 0.0;  ///< by the divergence theorem; means something where the mesh is closed

  /// Without boundary, edges of three triangles only where they are used equally in both directions
  /// (sheets that touch): it has an inside, and a volume.
  bool closed = false;
  /// Every edge is of two triangles, oriented alike, and every vertex of one fan.
  bool manifold() const {
    return boundaryEdges + nonManifoldEdges + flippedEdges + nonManifoldVertices == 0;
  }
  /// Closed, and its volume is positive.
  bool outward() const { return closed && volume > 0.0; }
};

/// Measure a mesh.
///   mesh  any; none of its triangles is needed
///   cost  triangles * log
[[nodiscard]] MeshQuality meshQuality(const TriangleMesh& mesh);

}  // namespace sherd
