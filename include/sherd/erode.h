// Erosion of fragments: simulates abrasion and lost shards.
#pragma once

#include <sherd/labels.h>
#include <sherd/leaf_blocks.h>
#include <sherd/progress.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// The structuring element: the cells around a voxel that are counted, for a size of 2r + 1:
///
///     cross      the three axes, r to either side   |x|, |y|, |z| <= r, at least two of them 0
///     square     the whole cube                     |x|, |y|, |z| <= r
///     ellipse    a ball                             x^2 + y^2 + z^2 <= r^2
///
/// Cross and ellipse of size 3 are the same 7 cells.
enum class ErodeShape { cross, square, ellipse };

/// Which voxels of a fragment's shell can erode.
enum class ErodeOn {
  fracture,  ///< those that touch another fragment or an eroded voxel
  all        ///< all, the original surface included
};

/// What happens to the smaller components of a fragment that erosion disconnects.
enum class Islands {
  eroded,  ///< they are eroded too, so that every fragment is 6-connected
  kept     ///< they stay in their fragment
};

struct ErodeOptions {
  ErodeShape shape = ErodeShape::ellipse;
  int size = 3;          ///< voxels across the shape, odd, 3..13
  bool planes = false;   ///< 2-D: uses the shape's section in each of the three axis planes; a
                         ///< voxel erodes if any section is filled below the threshold
  int iterations = 0;    ///< 0..1000; 0: no erosion
  double threshold = 1;  ///< least share of the shape's cells that must be filled, above 0, at most
                         ///< 1, rounded to a millionth; lower erodes less
  double probability = 1;  ///< of testing a voxel in an iteration, above 0, at most 1
  ErodeOn on = ErodeOn::fracture;
  Islands islands = Islands::eroded;
  std::uint64_t seed = 0;  ///< used only when probability < 1
};

struct Erosion {
  Labels labels;                      ///< eroded voxels are Labels::kEroded, others unchanged
  std::vector<std::uint64_t> eroded;  ///< [fragments+1] voxels lost, islands included; [0] the sum
};

/// Erodes fragments.  Each iteration tests the voxels of a fragment's shell, each with
/// `probability` (drawn anew); a voxel erodes if fewer than threshold * cells of its shape are
/// filled.  Cells are counted in the state before the iteration, so the order does not matter.
///
/// The shell is the fragment minus its erosion by 26 neighbors.  A cell is filled if it belongs to
/// the same fragment.  With ErodeOn::fracture only shell voxels are tested that have an inside
/// voxel of another fragment, an eroded voxel or an unlabeled one among their 26 neighbors, and
/// cells outside the solid count as filled, so the original surface does not move away from the
/// cracks.
///
/// A fragment never disappears: an iteration that would erode its last voxel is skipped for it.
/// Islands are handled once, after the last iteration: the 6-connected component with the most
/// voxels stays; of equal ones, the one with the first voxel in leaf order.
///
///   labels     inside voxels 0..fragments or Labels::kEroded; labels of the exterior band are
///              neither read nor changed: call extendLabels afterwards where they matter
///   fragments  1..kMaxFragments
///   cost       leaves * iterations, and shell voxels * size^2 * iterations on the host; islands
///   are
///              found on the device
///   throws     Error(usage) options out of range, labels that do not match `blocks`;
///              Error(device); Error(cancelled)
///   source     Generating implicit object fragment datasets for machine learning, 3.2.3
[[nodiscard]] Erosion erode(const LeafBlocks& blocks, const Labels& labels, int fragments,
                            const ErodeOptions& options, Device& device,
                            const Progress* progress = nullptr);

}  // namespace sherd
