// From what a reader found to a mesh.
#pragma once

#include <sherd/mesh.h>

#include "mesh/mesh_reader.h"

namespace sherd {

struct Merged {
  TriangleMesh mesh;
  SurfaceLook look;                     ///< of `mesh`, corner by corner
  std::size_t degenerateTriangles = 0;  ///< with two equal corners, dropped
};

/// Make exactly equal vertices one (0 and -0 are equal), drop triangles with two equal corners,
/// then vertices that no triangle uses.  What is left keeps its order.  Linear in the number of
/// vertices.
[[nodiscard]] Merged mergeVertices(const RawMesh& raw);

}  // namespace sherd
