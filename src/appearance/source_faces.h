// The faces of the input on which the faces of fragments lie.
#pragma once

#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <cstdint>
#include <vector>

#include "appearance/transfer.h"

namespace sherd {

/// No face of the input: on fracture surfaces, and where a hole of the input was closed.
inline constexpr std::int32_t kNoSourceFace = -1;

/// Returns the face of the input's file on which each face of a fragment's mesh lies, counted from
/// 0: that of AttributeSource::trianglesOf, or kNoSourceFace.  A hole is closed there where the
/// surface of the solid that is nearest to the face's centroid closes one.
///   triangles  of source.mesh, with findsTriangles
///   solid      made from it
///   return     [triangles]
[[nodiscard]] std::vector<std::int32_t> sourceFaces(const TriangleMesh& mesh,
                                                    const SourceMesh& source,
                                                    const AttributeSource& triangles,
                                                    const Solid& solid);

}  // namespace sherd
