// Surface::exact of bodies that are kept where they touch, overlap or lie within others.
#pragma once

#include <sherd/labels.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <functional>

#include "surface/exact/closed_solid.h"
#include "surface/exact/exact_surface.h"

namespace sherd {

/// Returns the meshes of all fragments as exactMeshes does: each body is cut for itself, the whole
/// of it.  Where its voxels are those of others, its fragments continue as far as they reach there.
/// Bodies without voxels are left out.  Where cracks are eroded, faces have neighbors of their
/// body.
///   solid   its mesh has bodies, see SolidMesh::body
///   cut     what exactMeshes does with the bodies of one layer
///   throws  Error(cancelled)
[[nodiscard]] ExactSurface keptMeshes(const Solid& solid, const Labels& labels,
                                      const std::function<ExactSurface(const ClosedSolid&)>& cut,
                                      const Progress* progress);

}  // namespace sherd
