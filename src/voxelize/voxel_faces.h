// The surface of labelled voxels.
#pragma once

#include <sherd/mesh.h>
#include <sherd/voxel_files.h>

namespace sherd {

/// The faces between voxels with a label and voxels without, two triangles each, outwards.
///   frame   of the box: its origin is the centre of the first voxel
///   return  empty where no voxel has a label
[[nodiscard]] TriangleMesh voxelFaces(const RunLengthVoxels& voxels, const GridFrame& frame);

}  // namespace sherd
