// The cut: signed distances from voxels to the cracks near them.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <cstdint>
#include <span>
#include <vector>

#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// Signed distances to the cut in one leaf, for every fragment within two voxels of it.
struct CutLeaf {
  std::vector<std::uint16_t> fragments;  ///< [n] ascending
  std::vector<float> distance;  ///< [n*512] voxels, inside the fragment negative, within -3..3;
                                ///< empty where CutExtent needs none
};

/// The cut over all leaves.  Eroded voxels count as one more fragment, Labels::kEroded, so that
/// eroded surfaces are as smooth as a cut.
///
/// Two binomial passes over labeled voxels smooth each fragment's indicator (s_i, in integers). The
/// cut lies where d_i = (max over j of s_j - s_i) / sum of s is zero.  Across a plane two binomial
/// passes convert the step to very nearly the normal distribution of variance 1, so the normal
/// quantile of d_i is the distance to the cut.  Where all voxels up to two away belong to the
/// nearest of the labels' sites, the bisector planes replace it (see site_cut.h).  Where two
/// fragments meet, d_i = -d_j to the bit, so they share the cut.  At the center of an inside voxel
/// the distance is clamped to at least kLeastDepth on its owner's side, so that no voxel changes
/// its owner: that could cut thin necks.  Fragments of fewer than 216 voxels are snapped to their
/// voxels' faces by a weight that reaches 1 at 64 voxels, because smoothing would leave little of
/// them.
struct Cut {
  static constexpr float kLeastDepth = 0.05f;  ///< voxels
  static constexpr std::uint32_t kWhole = 0xffffffffu;

  std::vector<std::uint16_t>
      only;  ///< [leaf] the only fragment within two voxels of the leaf, or 0; by CutExtent::cells
             ///< the only one within one voxel, or of inside voxels there
  std::vector<std::uint32_t> index;  ///< [leaf] into leaves, or kWhole
  std::vector<CutLeaf> leaves;
  std::vector<float> snapWeight;  ///< [65536] by label: 0..1, 1 snaps to its voxels' faces
};

/// Where distances to the cut are computed.
enum class CutExtent {
  everywhere,
  exact,  ///< everywhere, and not clamped where the cut is a plane, so that it is flat
  cells,  ///< at the corners of cells with several labels, enough for interface_surface.h
  none,   ///< nowhere: only which fragments are near a leaf is found
};

/// Returns the cut between all labels.
///   neighborhoods  of the leaves
///   throws         Error(cancelled)
[[nodiscard]] Cut findCut(const Labels& labels, std::span<const LeafNeighbors> neighborhoods,
                          CutExtent extent = CutExtent::everywhere,
                          const Progress* progress = nullptr);

}  // namespace sherd
