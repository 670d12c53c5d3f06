// The mesh of an intact object, beside those of its fragments.
#pragma once

#include <sherd/fracture.h>

namespace sherd {

/// Returns the mesh that a fracture into one fragment would have: with exact surfaces the input's
/// own, or the union of its bodies, else solidMesh, also where some fragments are smooth.
///   result   its fragments may not be made yet
///   options  the fracture's
[[nodiscard]] inline TriangleMesh intactMesh(const FractureResult& result,
                                             const SurfaceOptions& options) {
  const bool isExact =
      options.surface == Surface::exact && result.exactFailure.empty() && result.smooth.empty();
  if (!isExact || result.solid.mesh == nullptr) {
    return solidMesh(result.solid, options.adaptivity == kAutoAdaptivity ? kAutoAdaptivity : 0.0);
  }
  const SolidMesh& own = result.united.mesh ? *result.united.mesh : *result.solid.mesh;
  TriangleMesh mesh = own.mesh;
  mesh.source = own.source;
  return mesh;
}

}  // namespace sherd
