// Voxelizes a mesh once more, at a resolution that no option of the fracture changes.
#include "voxelize/canonical_solid.h"

#include <sherd/error.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>

#include "base/progress_part.h"
#include "voxelize/region.h"
#include "voxelize/voxelize.h"

namespace sherd {
namespace {

// Returns the resolution that resolves walls, a multiple of eight.
int resolutionForWalls(const WallThickness& walls) {
  return std::clamp((walls.forWalls + 7) / 8 * 8, CanonicalSolid::kResolution,
                    CanonicalSolid::kMostResolution);
}

// Of a quiet part of the work, which can be cancelled.
Progress quiet(const Progress* progress) {
  Progress out;
  if (progress != nullptr) out.cancelled = progress->cancelled;
  return out;
}

}  // namespace

CanonicalSolid::CanonicalSolid(const TriangleMesh& mesh, SolidOptions options)
    : longest_(longestSide(bounds(mesh))),
      mesh_{mesh.vertices, mesh.triangles},
      options_(std::move(options)) {}

std::shared_ptr<const Solid> CanonicalSolid::made(const Progress* progress) const {
  const Progress part = quiet(progress);
  SolidOptions options = options_;
  options.resolution = kResolution;
  options.voxelSize = 0.0;
  options.keepMesh = options.keepSeams = false;
  try {
    Solid solid = voxelizeAlone(mesh_, options, 1.0, &part);
    options.resolution = resolutionForWalls(solid.report.walls);
    if (options.resolution != kResolution) solid = voxelizeAlone(mesh_, options, 1.0, &part);
    return std::make_shared<const Solid>(std::move(solid));
  } catch (const Error& e) {
    if (e.code() != ErrorCode::input) throw;
    return nullptr;  // it has no voxels
  }
}

std::shared_ptr<const Solid> CanonicalSolid::otherThan(const Solid& solid,
                                                       const Progress* progress) {
  if (solid.frame.voxelSize == longest_ / kResolution &&
      resolutionForWalls(solid.report.walls) == kResolution) {
    return nullptr;
  }
  const std::lock_guard lock(making_);
  if (!isMade_) {
    tbb::this_task_arena::isolate([&] { solid_ = made(progress); });
    isMade_ = true;
    mesh_ = {};
  }
  const bool isOther = solid_ && solid_->frame.voxelSize != solid.frame.voxelSize;
  if (!isOther || solid_->report.fill != solid.report.fill) return nullptr;
  return solid_;
}

std::shared_ptr<const Solid> canonicalOf(const Solid& solid, const Progress* progress) {
  if (!solid.region || !solid.region->canonical()) return nullptr;
  return solid.region->canonical()->otherThan(solid, progress);
}

Solid voxelizeWithin(const TriangleMesh& source, const SolidOptions& options, double workShare,
                     const Progress* progress) {
  Solid solid = voxelizeAlone(source, options, workShare, progress);
  SolidRegion region = *solid.region;
  region.setCanonical(std::make_shared<CanonicalSolid>(source, options));
  solid.region = std::make_shared<const SolidRegion>(std::move(region));
  return solid;
}

Solid voxelize(const TriangleMesh& source, const SolidOptions& options, const Progress* progress) {
  return voxelizeWithin(source, options, 1.0, progress);
}

}  // namespace sherd
