// The cut: how far each voxel near a crack lies from it.
#pragma once

#include <sherd/labels.h>
#include <sherd/leaf_blocks.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// Signed distances to the cut in one leaf, for every fragment that reaches into it or nearly so.
struct CutLeaf {
  std::vector<std::uint16_t> fragments;  ///< [n] ascending
  std::vector<float> distance;  ///< [n*512] voxels, inside the fragment negative, within -3..3;
                                ///< empty where none was wanted
};

/// The cut over all leaves.  What is worn off counts as one more fragment, Labels::kWorn, so that
/// the surface it leaves is as smooth as a cut.
///
/// Each fragment's indicator is smoothed by two binomial passes over labelled voxels (s_i, in
/// integers); where d_i = (max over j of s_j - s_i) / sum of s is zero the cut lies.  Across a
/// plane two binomial passes turn the step into very nearly the normal distribution of variance 1,
/// so the normal quantile of d_i is the distance to the cut.  Where all voxels up to two away
/// belong to the nearest of the labels' sites the planes half way take its place (see site_cut.h).
/// Where two fragments meet d_i = -d_j to the bit, so they share the cut.  At the centre of an
/// inside voxel the distance is clamped to at least kLeastDepth on its owner's side: smoothing must
/// not give a voxel away, or it could cut thin necks.  Fragments of fewer than 216 voxels keep ever
/// more to their voxels' faces, those of up to 64 wholly: smoothing would leave little of them.
struct Cut {
  static constexpr float kLeastDepth = 0.05f;  ///< voxels
  static constexpr std::uint32_t kWhole = 0xffffffffu;

  std::vector<std::uint16_t>
      only;  ///< [leaf] the only fragment within two voxels of the leaf, or 0
  std::vector<std::uint32_t> index;  ///< [leaf] into leaves, or kWhole
  std::vector<CutLeaf> leaves;
  std::vector<float> stairs;  ///< [65536] by label: how far it keeps to its voxels' faces, 0..1
};

/// Where distances to the cut are found.
enum class CutExtent {
  everywhere,
  cells,  ///< at the corners of cells with several labels: all that interface_mesh.h needs
};

///   rounds  of the blocks
///   throws  Error(cancelled)
[[nodiscard]] Cut findCut(const LeafBlocks& blocks, const Labels& labels,
                          std::span<const LeafRound> rounds,
                          CutExtent extent = CutExtent::everywhere,
                          const Progress* progress = nullptr);

}  // namespace sherd
