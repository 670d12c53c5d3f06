// Inside and outside by flood fill between surfaces.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <vector>

#include "voxelize/fill/winding.h"

namespace sherd {

/// The voxel centers of a mesh's box, each with the least number of surfaces that a path of face
/// steps crosses from the outside.  Odd numbers are inside.
///
/// A step crosses a surface if it passes an odd number of triangles.  The orientation of triangles
/// does not matter, nor do holes that no step passes through.
///
/// Memory: one byte per voxel of the box.
class FloodedBox {
 public:
  /// mesh: in index space.
  ///   throws  Error(cancelled)
  explicit FloodedBox(const TriangleMesh& mesh, const Progress* progress = nullptr);

  [[nodiscard]] bool isInside(const openvdb::Coord& voxel) const;

 private:
  [[nodiscard]] std::size_t indexOf(const openvdb::Coord& voxel) const {
    const openvdb::Coord at = voxel - box_.min;
    const openvdb::Coord dims = box_.dims();
    return (static_cast<std::size_t>(at.x()) * static_cast<std::size_t>(dims.y()) +
            static_cast<std::size_t>(at.y())) *
               static_cast<std::size_t>(dims.z()) +
           static_cast<std::size_t>(at.z());
  }

  VoxelBox box_;  // of the mesh, one voxel wider on each side
  std::vector<std::uint8_t> depth_;
};

}  // namespace sherd
