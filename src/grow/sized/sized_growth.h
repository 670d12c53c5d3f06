// Growth of fragments with given shares, by weights of their seeds.
#pragma once

#include <sherd/labels.h>
#include <sherd/progress.h>

#include <vector>

#include "grow/fields/seeded_labels.h"
#include "grow/sized/least_share.h"

namespace sherd {

/// Grows from weighted seeds until the fragments have shares drawn from options.shares.sizes: each
/// within 2 % or 8 voxels, but at most 100 growths.  It ends sooner where 25 in a row do not lower
/// the greatest error; the growth with the least is returned.  Sizes are those of the labels, so
/// rough cracks and regrown voxels count.
///
/// Weights first grow by the squared radii that fragments lack, then Newton's method finds them:
/// the voxels of a fragment change with a weight by the area of its cracks over the gradient of the
/// difference of distances there.  A seed that a crack comes near moves to its fragment's center.
///   options  a growth that gives Voronoi cells
///   throws   Error(usage) minShare was not met; what grow and drawnShares throw
///   source   Kitagawa, Mérigot and Thibert, Convergence of a Newton algorithm for semi-discrete
///            optimal transport, 2019; Xin et al., Centroidal power diagrams with capacity
///            constraints, 2016 (the moves)
[[nodiscard]] SeededLabels grownToSizes(const Solid& solid, const VoxelComponents& components,
                                        std::vector<Seed> seeds, Device& device,
                                        const SharedGrowthOptions& options,
                                        const Progress* progress);

}  // namespace sherd
