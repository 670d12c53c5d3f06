// The paper's binary mesh, `.binm`.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Reads positions and faces in one of the layouts that the authors used over time:
///
///     u32 V | V x 64 bytes | u32 F | F x 16 bytes                     what is in the data set
///     u64 V | V x 64 bytes | u64 F | F x 16 bytes                     February 2024
///     u64 parts | the second, for each part                           before
///
/// A vertex is f32 x, y, z, 0, normal, 0, texture coordinates, 0, 0, tangent, 0; a face u32 a, b,
/// c, part.  The file's size decides which layout it is.
///   throws  Error(input) none of these, an index out of range
[[nodiscard]] RawMesh readBinm(const MeshFile& file);

}  // namespace sherd
