// Bodies of a mesh that share vertices, taken apart.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <span>

namespace sherd {

/// Gives closed bodies that touch in vertices, edges or faces, or that are equal, vertices of their
/// own at the same positions.  Triangles keep their order and their attributes.  Along an edge of
/// more than two triangles those belong to one body that have the inside between them; sheets
/// without a volume stay with what they touch.
///   mesh     oriented outwards, or all of it inwards
///   objects  [triangles] the object of each, or empty: closed objects are bodies of their own,
///            even where they share faces
[[nodiscard]] TriangleMesh withBodiesApart(TriangleMesh mesh,
                                           std::span<const std::uint32_t> objects = {});

}  // namespace sherd
