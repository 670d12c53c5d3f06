// Bodies of fragments that no crack connects to the rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "remesh/complex.h"

namespace sherd {

/// Whether a body, with its box, has voxels of a fragment.  Called on several threads.
using HasVoxels =
    std::function<bool(const TriangleMesh& body, const Box& box, std::uint16_t fragment)>;

/// Removes small bodies of fragments that are not their largest and that no crack bounds: parts of
/// the input that the solid has no voxels of, so that no fragment is theirs.  What touches the rest
/// in vertices only is a body.
///   meshes     [fragments] closed
///   least      volume of a body that stays, world units
///   hasVoxels  of those that are little larger
///   return     number of bodies removed
std::size_t removeLooseBodies(std::vector<LabeledMesh>& meshes, double least,
                              const HasVoxels& hasVoxels);

/// Returns the number of the mesh's bodies: of the parts, connected by vertices at one position,
/// that have a volume above 0.  Cavities have less.
[[nodiscard]] std::size_t bodyCount(const TriangleMesh& mesh);

}  // namespace sherd
