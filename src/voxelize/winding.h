// How often a closed mesh winds round each voxel centre.
#pragma once

#include <sherd/coords.h>
#include <sherd/mesh.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace sherd {

/// Winding numbers of a closed mesh along the voxel columns of its box.
///
/// Every column of voxel centres along z is a ray; a triangle that it passes changes the winding
/// number by one, up or down by the side it is met from.  Which triangles a ray passes is decided
/// in integers, on vertices snapped to 1/65536 voxel, with ties broken as if the ray were moved by
/// an infinitely small step: of the triangles round an edge or a vertex each ray passes a
/// consistent set, so a closed mesh gives closed columns, exactly.
class Winding {
 public:
  /// mesh: in index space, closed.
  explicit Winding(const TriangleMesh& mesh);

  /// Bit z of the result: the winding number at (x, y, z0 + z) is 1 or more; z in 0..7.
  std::uint8_t insideRow(int x, int y, int z0) const;

  /// The winding number above the whole mesh: 0 in every column when it is closed.
  int windingAbove(int x, int y) const;

  /// The lowest and the highest winding number of any voxel centre (0 outside the mesh's box).
  int lowest() const { return lowest_; }
  int highest() const { return highest_; }

  std::uint64_t insideVoxels() const { return insideVoxels_; }

 private:
  // From voxel z upwards the winding number is `winding`, until the column's next change.
  struct Change {
    std::int32_t z;
    std::int32_t winding;
  };

  // The column's number, or none outside the box.
  std::optional<std::size_t> columnAt(int x, int y) const;

  VoxelBox box_;                    // columns: x and y of the box
  std::vector<std::size_t> first_;  // [columns + 1] into changes_
  std::vector<Change> changes_;
  int lowest_ = 0;
  int highest_ = 0;
  std::uint64_t insideVoxels_ = 0;
};

}  // namespace sherd
