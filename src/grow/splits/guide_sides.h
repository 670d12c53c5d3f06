// On which side of a given crack the voxels of a solid lie.
#pragma once

#include <sherd/solid.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "mesh/search/sided_mesh.h"

namespace sherd {

/// Returns the inside voxels whose centers lie on the positive side of a surface, as words like
/// LeafBlocks::inside.
///   throws  Error(cancelled)
///   cost    a closest triangle for each voxel, or for each leaf that is far from the surface
[[nodiscard]] std::vector<std::uint64_t> positiveSide(const LeafBlocks& blocks,
                                                      const GridFrame& frame,
                                                      const SidedMesh& surface,
                                                      const Progress* progress = nullptr);

/// Cracks that are given, in the voxels of a solid.  Thread-safe.
class GivenCracks {
 public:
  GivenCracks(std::vector<SidedMesh> surfaces, const GridFrame& frame)
      : surfaces_(std::move(surfaces)), frame_(frame) {}

  [[nodiscard]] const std::vector<SidedMesh>& surfaces() const { return surfaces_; }

  /// Returns the signed distance of a voxel's center from a crack, voxels.
  ///   guess  as SidedMesh::Side has it, of a voxel nearby; becomes this voxel's
  [[nodiscard]] double distance(std::size_t crack, const openvdb::Coord& voxel,
                                std::uint32_t& guess) const {
    const SidedMesh::Side side = surfaces_[crack].sideOf(frame_.worldFromIndex(voxel), guess);
    guess = side.guess;
    return side.distance / frame_.voxelSize;
  }

 private:
  std::vector<SidedMesh> surfaces_;
  GridFrame frame_;
};

/// Cracks by which pieces are split first.
struct GuideSides {
  std::vector<std::vector<std::uint64_t>> positive{};  ///< [cracks] as positiveSide
  std::shared_ptr<const GivenCracks> cracks{};         ///< null: cracks are cut by labels
  std::vector<std::size_t> guide{};                    ///< [cracks] index of the guide
};

}  // namespace sherd
