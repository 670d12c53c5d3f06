// The loop over the halo of a leaf that cuts by seeds and by splits share.
#pragma once

#include <bit>

#include "cut/halo_bits.h"

namespace sherd {

/// Returns the cut of a leaf, row by row of its halo.
///   leaf    bounds fragments by planes, or other surfaces:
///             setRow(x, y, {first, last})  the row whose voxels are asked next, and those needed
///             agrees(label, z)             whether a voxel belongs to the fragment by the planes
///             hasCut(k)                    whether the k-th fragment has a surface in the leaf
///             toCut(k, z)                  distance of a voxel to it, at most 3, in voxels
///   others  as siteCut
template <class Leaf>
[[nodiscard]] SiteCut cutOfLeaf(const CutHalo& halo, std::size_t fragments,
                                const VoxelBits& requested, Leaf& leaf) {
  SiteCut cut;
  cut.distance.assign(fragments * 512, 3.0f);
  HaloBits own{}, mismatches{};
  for (std::size_t row = 0; row < 64; ++row) {
    own[haloRow(row)] = static_cast<std::uint16_t>(requested[row] << kCutHalo);
  }
  HaloBits tested = dilated(own);
  for (std::size_t row = 0; row < tested.size(); ++row) {
    unsigned labeled = 0;
    for (std::size_t z = 0; z < kCutSide; ++z)
      labeled |= static_cast<unsigned>(halo[row * kCutSide + z] != 0) << z;
    tested[row] &= static_cast<std::uint16_t>(labeled);
    const auto needed = static_cast<std::uint16_t>(tested[row] | own[row]);
    if (needed == 0) continue;
    leaf.setRow(row / kCutSide, row % kCutSide,
                {static_cast<std::size_t>(std::countr_zero(needed)),
                 static_cast<std::size_t>(std::bit_width(needed))});
    for (unsigned bits = tested[row]; bits != 0; bits &= bits - 1) {
      const auto z = static_cast<std::size_t>(std::countr_zero(bits));
      if (!leaf.agrees(halo[row * kCutSide + z], z)) {
        mismatches[row] |= static_cast<std::uint16_t>(1u << z);
      }
    }
    for (unsigned bits = own[row]; bits != 0; bits &= bits - 1) {
      const auto z = static_cast<std::size_t>(std::countr_zero(bits));
      const std::size_t v =
          (row / kCutSide - kCutHalo) * 64 + (row % kCutSide - kCutHalo) * 8 + z - kCutHalo;
      for (std::size_t k = 0; k < fragments; ++k) {
        if (leaf.hasCut(k)) cut.distance[k * 512 + v] = leaf.toCut(k, z);
      }
    }
  }
  const HaloBits fails = dilated(mismatches);
  for (std::size_t row = 0; row < 64; ++row) {
    cut.holds[row] = static_cast<std::uint8_t>(requested[row] & ~(fails[haloRow(row)] >> kCutHalo));
  }
  return cut;
}

}  // namespace sherd
