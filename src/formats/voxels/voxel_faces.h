// The surface of labeled voxels.
#pragma once

#include <sherd/files.h>
#include <sherd/mesh.h>

#include <cstddef>
#include <optional>

namespace sherd {

/// Returns the faces between labeled and unlabeled voxels, two triangles each, facing outward.
///   frame   of the box: its origin is the center of the first voxel
///   most    limit on triangles: a file of a few bytes can represent any number
///   return  an empty mesh if no voxel has a label; nothing beyond `most` triangles
///   throws  Error(cancelled)
[[nodiscard]] std::optional<TriangleMesh> voxelFaces(const RunLengthVoxels& voxels,
                                                     const GridFrame& frame, std::size_t most,
                                                     const Progress* progress = nullptr);

}  // namespace sherd
