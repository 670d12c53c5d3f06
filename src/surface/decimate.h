// Decimation of meshes that share faces.
#pragma once

#include <sherd/fragments.h>

#include <span>
#include <vector>

#include "surface/complex.h"

namespace sherd {

/// Decimates all labels of a complex together until each has at most the given number of triangles,
/// or no collapse is allowed.  A label next to a larger one may end with fewer.
///   return  [labels][k] in the order of `triangles`; see sherd/fragments.h
///   throws  Error(cancelled)
[[nodiscard]] std::vector<std::vector<TriangleMesh>> decimated(
    const Complex& complex, std::span<const std::size_t> triangles,
    const Progress* progress = nullptr);

/// Decimates all labels of a complex as far as vertices stay near the planes of the faces that they
/// replace.
///   error   root mean square distance to the planes, world units
///   return  [labels]
///   throws  Error(cancelled)
[[nodiscard]] std::vector<LabeledMesh> simplified(const Complex& complex, double error,
                                                  const Progress* progress = nullptr);

}  // namespace sherd
