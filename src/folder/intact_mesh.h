// The mesh of an intact object, beside those of its fragments.
#pragma once

#include <sherd/fracture.h>

namespace sherd {

/// Returns the mesh that a fracture into one fragment would have: with exact surfaces the input's
/// own, else solidMesh.
///   result   its fragments may not be made yet
///   options  the fracture's
[[nodiscard]] inline TriangleMesh intactMesh(const FractureResult& result,
                                             const SurfaceOptions& options) {
  const bool isExact = options.surface == Surface::exact && result.exactFailure.empty();
  if (!isExact || result.solid.mesh == nullptr) {
    return solidMesh(result.solid, options.adaptivity == kAutoAdaptivity ? kAutoAdaptivity : 0.0);
  }
  TriangleMesh mesh = result.solid.mesh->mesh;
  mesh.source = result.solid.mesh->source;
  return mesh;
}

}  // namespace sherd
