// Exact surfaces of the bodies that can be cut, where others can't.
#pragma once

#include <sherd/labels.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <functional>

#include "surface/exact/body_clusters.h"
#include "surface/exact/exact_surface.h"

namespace sherd {

/// Cuts clusters of bodies one by one, after the whole could not be cut.
///   before   labels before erosion, or the same
///   failed   of the whole, which is returned if no cluster can be cut, or there is only one
///   cut      a cluster
///   return   meshes of the clusters that could be cut, and the others as ExactSurface::smooth
///   throws   Error(cancelled)
[[nodiscard]] ExactSurface cutByCluster(const Solid& solid, const Labels& labels,
                                        const Labels& before, ExactSurface failed,
                                        const std::function<ExactSurface(const ClusterSolid&)>& cut,
                                        const Progress* progress);

/// Numbers vertices at one position alike, also those of different fragments.
void setPositions(std::vector<LabeledMesh>& meshes);

}  // namespace sherd
