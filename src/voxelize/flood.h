// The inside by colouring the regions between surfaces.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <vector>

#include "voxelize/winding.h"

namespace sherd {

/// Voxel centres of a mesh's box, each with the least number of surfaces between it and the
/// outside, along steps from voxel to voxel.  An odd number is inside.
///
/// A step crosses a surface when triangles part its two ends an odd number of times.  What way
/// triangles are turned does not matter, nor do holes that no step leads through.
///
/// One byte a voxel of the box.
class FloodedBox {
 public:
  /// mesh: in index space.
  ///   throws  Error(cancelled)
  explicit FloodedBox(const TriangleMesh& mesh, const Progress* progress = nullptr);

  [[nodiscard]] bool isInside(const openvdb::Coord& voxel) const;

 private:
  [[nodiscard]] std::size_t place(const openvdb::Coord& voxel) const {
    const openvdb::Coord at = voxel - box_.min;
    const openvdb::Coord dims = box_.dims();
    return (static_cast<std::size_t>(at.x()) * static_cast<std::size_t>(dims.y()) +
            static_cast<std::size_t>(at.y())) *
               static_cast<std::size_t>(dims.z()) +
           static_cast<std::size_t>(at.z());
  }

  VoxelBox box_;  // of the mesh, and a voxel all round
  std::vector<std::uint8_t> depth_;
};

}  // namespace sherd
