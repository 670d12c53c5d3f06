// The surface of labelled voxels.
#pragma once

#include <sherd/mesh.h>
#include <sherd/voxel_files.h>

#include <cstddef>
#include <optional>

namespace sherd {

/// The faces between voxels with a label and voxels without, two triangles each, outwards.
///   frame   of the box: its origin is the centre of the first voxel
///   most    triangles: a file of a few bytes may stand for any number
///   return  empty where no voxel has a label; none where there would be more triangles
///   throws  Error(cancelled)
[[nodiscard]] std::optional<TriangleMesh> voxelFaces(const RunLengthVoxels& voxels,
                                                     const GridFrame& frame, std::size_t most,
                                                     const Progress* progress = nullptr);

}  // namespace sherd
