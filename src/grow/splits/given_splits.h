// Splits that are decided before, on another solid of the same mesh.
#pragma once

#include <sherd/labels.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "voxelize/canonical_solid.h"

namespace sherd {

/// A split, and how many fragments come of the piece that keeps its id.
struct GivenSplit {
  Split split;
  std::size_t kept = 1;
};

/// All splits of a fracture.
struct GivenSplits {
  /// The piece of a connected component.
  struct Root {
    std::uint16_t id = 0;
    std::size_t fragments = 1;
  };

  std::vector<Root> roots{};         ///< [components]
  std::vector<GivenSplit> splits{};  ///< those of a piece in their order
  std::vector<double> shares{};      ///< of the fragments that are meant, component by component
  std::uint64_t leastVoxels = 0;     ///< of a fragment, of the voxels on which they were decided
};

/// Returns splits for another solid of the mesh.
///   component  [components of that] the component of the solid of these splits, each once
[[nodiscard]] GivenSplits givenFor(const GivenSplits& decided, const VoxelScale& scale,
                                   std::span<const std::uint32_t> component);

/// The splits of one fracture that are still to be made, piece by piece.
class GivenOrder {
 public:
  GivenOrder() = default;
  explicit GivenOrder(const GivenSplits& splits);

  /// Returns the next split of a piece, or null.
  [[nodiscard]] const GivenSplit* next(std::uint16_t id) const;

  /// Records that it is made.
  void advance(std::uint16_t id) { ++at_[id]; }

  /// Takes the splits that are left away from a piece and those that would come of it.
  ///   return  the ids that these would have had
  [[nodiscard]] std::vector<std::uint16_t> dropped(std::uint16_t id);

 private:
  const GivenSplits* splits_ = nullptr;
  std::vector<std::vector<std::size_t>> ofPiece_{};  // [ids + 1] indices of splits
  std::vector<std::size_t> at_{};                    // [ids + 1] the next of these
};

}  // namespace sherd
