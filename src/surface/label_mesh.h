// The faces of voxels as a mesh: Surface::labels.
#pragma once

#include <sherd/labels.h>
#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// A side of a voxel whose adjacent voxel does not belong to the fragment.
struct VoxelFace {
  openvdb::Coord voxel;
  int direction = 0;           ///< 0..5: -x +x -y +y -z +z
  std::uint16_t neighbor = 0;  ///< 0 original surface, else the fragment on the other side
};

/// Returns the faces of a fragment's voxels.  The neighbor of a face on eroded voxels is searched
/// straight behind them, up to kMaxErosionDepth voxels away.
///   uneroded  labels before erosion; `labels` if there was none
///   leaves    a superset of the leaves that hold the fragment
[[nodiscard]] std::vector<VoxelFace> facesOf(const Solid& solid, const Labels& labels,
                                             const Labels& uneroded, std::uint16_t fragment,
                                             std::span<const std::uint32_t> leaves);

/// Returns all faces of a set of voxels as a mesh with neighbors: closed, edge- and
/// vertex-manifold, oriented outwards, world units.  Volume and area are those of the voxels,
/// except that vertices where sheets touch are moved inwards by `offsetVoxels`.  Squares are split
/// at the diagonal of the corners with an even coordinate sum, so two fragments split a shared face
/// alike.
[[nodiscard]] TriangleMesh meshOfFaces(std::span<const VoxelFace> faces, const GridFrame& frame,
                                       double offsetVoxels = 1.0 / 64);

}  // namespace sherd
