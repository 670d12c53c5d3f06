// The union of the bodies of one mesh.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <string>

namespace sherd {

/// A mesh whose bodies are united, or why it could not be made.
struct UnitedMesh {
  TriangleMesh mesh{};     ///< with TriangleMesh::source by the mesh that was given
  bool isChanged = false;  ///< whether it is not what was given
  std::string failure{};   ///< a clause; empty if `mesh` is valid
};

/// Returns whether components of a closed mesh, those of triangles connected over edges, touch,
/// overlap or lie within others so that the winding number is 2 or more somewhere; exact.  A body
/// that only crosses itself is not found.
///   mesh    vertices at one position are one vertex
///   throws  Error(cancelled)
[[nodiscard]] bool componentsMeet(const TriangleMesh& mesh, const Progress* progress = nullptr);

/// Returns the surface between the points where the winding number of a closed mesh is at least 1
/// and those where it is at most 0: bodies that overlap or touch are united, those within others
/// vanish, and inverted ones remain cavities.  Triangles that nothing touches stay as they are.
/// All decisions are exact; new vertices are rounded.  Where the result touches itself, vertices
/// and edges may belong to several sheets.
///   mesh    closed, consistently oriented; triangles without area are left out
///   throws  Error(cancelled)
///   source  Zhou, Grinspun, Zorin, Jacobson: Mesh Arrangements for Solid Geometry, 2016
[[nodiscard]] UnitedMesh unite(const TriangleMesh& mesh, const Progress* progress = nullptr);

}  // namespace sherd
