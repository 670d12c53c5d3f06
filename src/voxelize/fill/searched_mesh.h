// A mesh with the data that several steps share.
#pragma once

#include <sherd/mesh.h>

#include <memory>

#include "mesh/search/triangle_tree.h"

namespace sherd {

/// A mesh with the data that several steps share.
struct SearchedMesh {
  TriangleMesh mesh;
  TriangleMesh caps;                         ///< loopCaps(mesh)
  std::shared_ptr<const TriangleTree> tree;  ///< of `mesh`
};
[[nodiscard]] SearchedMesh searched(TriangleMesh mesh);

}  // namespace sherd
