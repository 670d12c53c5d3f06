// The faces of voxels as a mesh: Surface::labels.
#pragma once

#include <sherd/labels.h>
#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// One side of a voxel that has no voxel of its body beyond it.
struct VoxelFace {
  openvdb::Coord voxel;
  int direction = 0;         ///< 0..5: -x +x -y +y -z +z
  std::uint16_t facing = 0;  ///< 0 original surface, else the fragment on the other side
};

/// The faces of a fragment's voxels.  Beyond a face lies the outside, another fragment, or worn
/// voxels: then what is found straight behind them, up to kDeepestWear voxels away.
///   unworn  labels before wear; `labels` where there was none
///   leaves  those that hold the fragment, or more
[[nodiscard]] std::vector<VoxelFace> facesOf(const Solid& solid, const Labels& labels,
                                             const Labels& unworn, std::uint16_t fragment,
                                             std::span<const std::uint32_t> leaves);

struct VoxelMesh {
  TriangleMesh mesh;                  ///< closed, edge- and vertex-manifold, outwards, world units
  std::vector<std::uint16_t> facing;  ///< [triangles]
};

/// All faces of a set of voxels as a mesh.  Volume and area are those of the voxels, but for sheets
/// that touch: these stand `apart` voxels back from each other.  Squares are split at the diagonal
/// of corners with an even sum, so two bodies that share a face split it alike.
[[nodiscard]] VoxelMesh meshOfFaces(std::span<const VoxelFace> faces, const GridFrame& frame,
                                    double apart = 1.0 / 64);

}  // namespace sherd
