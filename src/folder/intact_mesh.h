// The mesh of an intact object, beside those of its fragments.
#pragma once

#include <sherd/fracture.h>

namespace sherd {

/// Returns the mesh that a fracture into one fragment would have: with exact surfaces the input's
/// own, else solidMesh.
///   result   its fragments may not be made yet
///   surface  of the fracture's options
[[nodiscard]] inline TriangleMesh intactMesh(const FractureResult& result, Surface surface) {
  const bool isExact = surface == Surface::exact && result.exactFailure.empty();
  if (!isExact || result.solid.mesh == nullptr) return solidMesh(result.solid);
  TriangleMesh mesh = result.solid.mesh->mesh;
  mesh.source = result.solid.mesh->source;
  return mesh;
}

}  // namespace sherd
