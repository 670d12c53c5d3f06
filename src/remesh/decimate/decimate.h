// Decimation of meshes that share faces.
#pragma once

#include <sherd/fragments.h>

#include <functional>
#include <span>
#include <vector>

#include "remesh/complex.h"

namespace sherd {

/// Decimates all labels of a complex together until each has at most the given number of triangles,
/// or no collapse is allowed.  A label next to a larger one may end with fewer.
///   return  [labels][k] in the order of `triangles`; see sherd/fragments.h
///   throws  Error(cancelled)
[[nodiscard]] std::vector<std::vector<TriangleMesh>> decimated(
    const LabeledComplex& complex, std::span<const std::size_t> triangles,
    const Progress* progress = nullptr);

/// Decimates all labels of a complex as far as vertices stay near the planes of the faces that they
/// replace.
///   error   root mean square distance to the planes, world units
///   return  [labels]
///   throws  Error(cancelled)
[[nodiscard]] std::vector<LabeledMesh> simplified(const LabeledComplex& complex, double error,
                                                  const Progress* progress = nullptr);

/// How far surfaces of which no mesh is made are simplified.
struct CollapseRules {
  double error = 0.0;        ///< root mean square distance to the planes
  double leastHeight = 0.0;  ///< of faces, unless they had less before
  /// Whether the edge of two vertices, at which a surface ends, may become one of two others:
  /// returns it for `from` and `end`, of which `from` becomes `to`.
  std::function<bool(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& end)> mayMove;
};

/// Collapses edges of surfaces of which no mesh is made (LabeledComplex::labels 0), which may be
/// open, as far as vertices stay near the planes of the faces that they replace.
///   surface  without crossings; none of the result's faces cross either
///   throws   Error(cancelled)
[[nodiscard]] LabeledComplex collapsed(const LabeledComplex& surface, const CollapseRules& rules,
                                       const Progress* progress = nullptr);

}  // namespace sherd
