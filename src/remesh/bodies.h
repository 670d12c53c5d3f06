// The bodies of a mesh of several closed components.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <vector>

namespace sherd {

/// Splits a closed mesh into bodies that may overlap or touch: the components that are oriented
/// outwards, each with the cavities within it.  Sheets that touch belong to different components.
///   mesh    oriented
///   return  with TriangleMesh::source by the mesh's triangles; empty if the mesh is not closed
///   throws  Error(cancelled)
[[nodiscard]] std::vector<TriangleMesh> bodiesOf(const TriangleMesh& mesh,
                                                 const Progress* progress = nullptr);

}  // namespace sherd
