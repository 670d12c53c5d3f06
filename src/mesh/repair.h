// What is wrong with a mesh, and the mesh with its triangles turned the same way.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

namespace sherd {

struct Repaired {
  TriangleMesh mesh;  ///< the same vertices
  MeshDefects defects;
};

/// Drop doubled triangles, turn triangles the way of their neighbours, and parts that are inside
/// out.
///
/// Of equal triangles that are turned alike one is kept; a pair turned against each other goes
/// altogether: the solid lies on both sides of it, or on none.  Where edges of a part do not
/// balance, its triangles are turned to agree across edges of two triangles, each group the way
/// most of its area was.  A part is inside out when it winds backwards round most points just
/// behind its surface; it is turned unless it lies within another, where it bounds a cavity.
///   throws  Error(cancelled)
[[nodiscard]] Repaired repaired(const TriangleMesh& mesh, const Progress* progress = nullptr);

}  // namespace sherd
