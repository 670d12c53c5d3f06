// Erosion: wearing fragments down, as abrasion and lost shards do.
#pragma once

#include <sherd/labels.h>
#include <sherd/leaf_blocks.h>
#include <sherd/progress.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// The cells round a voxel that are counted, for a size of 2r + 1:
///
///     cross      the three axes, r to either side   |x|, |y|, |z| <= r, at least two of them 0
///     square     the whole cube                     |x|, |y|, |z| <= r
///     ellipse    a ball                             x^2 + y^2 + z^2 <= r^2
///
/// Cross and ellipse of size 3 are the same 7 cells.
enum class ErodeShape { cross, square, ellipse };

/// Which part of a fragment's shell can wear.
enum class ErodeOn {
  fracture,  ///< voxels that touch another fragment or a worn voxel: the cracks
  all        ///< every voxel of the shell, the original surface too
};

/// What becomes of the smaller parts of a fragment that falls apart.
enum class Crumbs {
  worn,  ///< they wear away; every fragment is one 6-connected part again
  kept   ///< they stay voxels of their fragment
};

struct ErodeOptions {
  ErodeShape shape = ErodeShape::ellipse;
  int size = 3;          ///< voxels across the shape, odd, 3..13
  bool planes = false;   ///< 2-D: the shape's section by each of the three axis planes; a voxel is
                         ///< worn where one of the three is filled too little
  int iterations = 0;    ///< how often the shell is tested, 0..1000; 0 wears nothing at all
  double threshold = 1;  ///< share of the shape's cells that must be filled, above 0, at most 1, to
                         ///< the nearest millionth; lower is gentler
  double probability = 1;  ///< that a voxel is tested in an iteration, above 0, at most 1
  ErodeOn on = ErodeOn::fracture;
  Crumbs crumbs = Crumbs::worn;
  std::uint64_t seed = 0;  ///< used only when probability < 1
};

struct Erosion {
  Labels labels;                    ///< worn voxels are Labels::kWorn, all else as it was
  std::vector<std::uint64_t> worn;  ///< [fragments+1] voxels each lost, crumbs too; [0] the sum
};

/// Wear fragments down.  In each iteration the voxels of a fragment's shell are tested, each with
/// `probability`, a new draw every time; a voxel is worn when fewer than threshold * cells of its
/// shape are filled.  Filled is counted as it was when the iteration began, so no order matters.
///
/// The shell is the fragment less its erosion by 26 neighbours.  A cell is filled when it is the
/// fragment's own.  Under ErodeOn::fracture only those shell voxels are tested that have an inside
/// voxel not of their fragment among their 26 neighbours (another fragment's, worn, or without
/// label), and a cell outside the solid counts as filled, so that the original surface stays where
/// it was away from the cracks.
///
/// A fragment is never worn away: an iteration that would take its last voxel does not happen to
/// it.  Crumbs are dealt with once, after the last iteration: of a fragment's 6-connected parts the
/// one with the most voxels stays, of equal ones that with the first voxel in leaf order.
///
///   labels     inside voxels 0..fragments or Labels::kWorn; labels of the outer band are neither
///              read nor changed, so carry them anew where that matters
///   fragments  1..kMaxFragments
///   cost       leaves * iterations, and shell voxels * size^2 * iterations on the host; crumbs are
///              found on the device
///   throws     Error(usage) options out of range, labels that are not those of `blocks`;
///              Error(device); Error(cancelled)
///   source     Generating implicit object fragment datasets for machine learning, 3.2.3
[[nodiscard]] Erosion erode(const LeafBlocks& blocks, const Labels& labels, int fragments,
                            const ErodeOptions& options, Device& device,
                            const Progress* progress = nullptr);

}  // namespace sherd
