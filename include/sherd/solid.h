// The solid: a mesh as a narrow-band signed distance grid and its leaf blocks.
#pragma once

#include <sherd/coords.h>
#include <sherd/grid_fwd.h>
#include <sherd/leaf_blocks.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <cstdint>

namespace sherd {

class Device;

/// Half width of every narrow band, in voxels.
inline constexpr int kHalfWidthVoxels = 3;

/// Parts of the solid with fewer voxels than this are specks: dropped and counted.
inline constexpr std::uint64_t kSpeckVoxels = 27;

struct SolidOptions {
  int resolution =
      128;  ///< voxels along the mesh's longest side, 8..4096; used when voxelSize is 0
  double voxelSize = 0.0;  ///< world units per voxel; 0: from resolution
};

/// A solid, read-only once returned.
struct Solid {
  GridFrame frame;
  ConstFloatGridPtr distance;     ///< level set, world units, inside negative, half width 3 voxels
  LeafBlocks blocks;              ///< inside and outer-band voxels of `distance`
  VoxelBox box;                   ///< tight box of the inside voxels
  std::uint64_t voxels = 0;       ///< inside voxels
  std::uint64_t specks = 0;       ///< parts dropped for having fewer than kSpeckVoxels voxels
  std::uint64_t speckVoxels = 0;  ///< voxels in them
};

/// Turn a closed mesh into a solid.  A voxel is inside when the mesh winds round its centre at
/// least once, decided exactly; so closed parts that overlap unite, and a part oriented inwards
/// within another is a cavity.  A mesh whose total volume is negative is turned over first.
///   mesh    closed: openEdges(mesh) == 0
///   throws  Error(input) open mesh, box empty or not finite, nothing inside at this resolution;
///           Error(usage) resolution or voxel size out of range
[[nodiscard]] Solid voxelize(const TriangleMesh& mesh, const SolidOptions& options = {},
                             const Progress* progress = nullptr);

/// The voxel size that `options` asks for on this mesh.
[[nodiscard]] double voxelSizeFor(const TriangleMesh& mesh, const SolidOptions& options);

}  // namespace sherd
