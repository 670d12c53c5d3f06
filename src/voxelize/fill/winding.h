// Winding numbers of a closed mesh at voxel centers.
#pragma once

#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace sherd {

/// Winding numbers of a closed mesh along the voxel columns of its box.
///
/// Every column of voxel centers along z is a ray; each triangle that it passes changes the winding
/// number by +1 or -1, depending on the side.  The triangles are found with integer arithmetic, on
/// vertices snapped to a lattice (2^-22 voxel in a box of 250 voxels, proportional to the box), and
/// ties are broken as if the ray were moved by an infinitesimal step.  So each ray passes a
/// consistent set of the triangles around an edge or a vertex, and a closed mesh gives closed
/// columns exactly.
class Winding {
 public:
  /// The effect of a crossing.
  enum class Rule {
    signedCrossings,  ///< +1 or -1, depending on the side of the triangle
    parity,           ///< toggles between 0 and 1, for any orientation of triangles
  };

  /// mesh: in index space, closed; for parity, triangles may have any orientation.
  ///   throws  Error(cancelled)
  explicit Winding(const TriangleMesh& mesh, Rule rule = Rule::signedCrossings,
                   const Progress* progress = nullptr);

  /// A face at most so many voxels above a center counts as below it: faces are often at centers,
  /// up to rounding.
  static constexpr double kTieAlongZ = 1e-9;

  /// The lattice that vertices are snapped to has steps of 2^-bits voxels.
  static int latticeBits(const Box& box);

  /// The winding number at a voxel center.
  int at(const openvdb::Coord& voxel) const;

  /// Whether it is 1 or more there.
  bool isInside(const openvdb::Coord& voxel) const { return at(voxel) > 0; }

  /// The winding number above the whole mesh: 0 in every column when it is closed.
  int windingAbove(int x, int y) const;

  /// The lowest and the highest winding number of any voxel center (0 outside the mesh's box).
  int lowest() const { return lowest_; }
  int highest() const { return highest_; }

  /// Calls visit(x, y, z, end, winding) for each run of voxels z..end-1 of a column with the same
  /// nonzero winding number.
  template <class Visit>
  void forEachRun(Visit&& visit) const {
    const auto ny = static_cast<std::size_t>(box_.dims().y());
    for (std::size_t c = 0; c + 1 < first_.size(); ++c) {
      const int x = box_.min.x() + static_cast<int>(c / ny);
      const int y = box_.min.y() + static_cast<int>(c % ny);
      for (std::size_t i = first_[c]; i + 1 < first_[c + 1]; ++i) {
        const Change &from = changes_[i], &to = changes_[i + 1];
        if (from.winding != 0 && from.z != to.z) visit(x, y, from.z, to.z, from.winding);
      }
    }
  }

  /// The box of the stored columns; outside it all winding numbers are 0.
  const VoxelBox& box() const { return box_; }

  std::uint64_t insideVoxels() const { return insideVoxels_; }

 private:
  // From voxel z upwards the winding number is `winding`, until the column's next change.
  struct Change {
    std::int32_t z;
    std::int32_t winding;
  };

  // Returns the column's index, or nullopt outside the box.
  std::optional<std::size_t> columnAt(int x, int y) const;

  VoxelBox box_;                    // columns: x and y of the box
  std::vector<std::size_t> first_;  // [columns + 1] into changes_
  std::vector<Change> changes_;
  int lowest_ = 0;
  int highest_ = 0;
  std::uint64_t insideVoxels_ = 0;
};

}  // namespace sherd
