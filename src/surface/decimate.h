// Decimating meshes that share faces.
#pragma once

#include <sherd/surface.h>

#include <span>
#include <vector>

#include "surface/complex.h"

namespace sherd {

/// Decimate all labels of a complex at once until none has more than so many triangles, or none can
/// be had with less: a label beside a larger one may end with fewer.
///   return  [labels][k] in the order of `triangles`; see sherd/surface.h
///   throws  Error(cancelled)
[[nodiscard]] std::vector<std::vector<CoarseMesh>> decimated(const Complex& complex,
                                                             std::span<const std::size_t> triangles,
                                                             const Progress* progress = nullptr);

/// As few polygons as may be had while vertices stay near the planes of the faces they stand for.
///   error   root of the mean squared distance to them, world units
///   return  [labels]
///   throws  Error(cancelled)
[[nodiscard]] std::vector<LabelledFaces> simplified(const Complex& complex, double error,
                                                    const Progress* progress = nullptr);

}  // namespace sherd
