// The stages in order, timed.
#include <sherd/fracture.h>

#include <memory>
#include <utility>

#include "cl/device_impl.h"
#include "grow/fields/small_components.h"
#include "pipeline/deciding.h"
#include "pipeline/fracture_stages.h"
#include "voxelize/wall_middles.h"

namespace sherd {
namespace {

GrownFracture grownOf(Solid solid, const FractureOptions& options, StageClock clock, Device& device,
                      const Progress* progress) {
  PreparedSolid ready = prepared(std::move(solid), device);
  clock.done("components");
  GrownFracture grown = grow(ready, options, device, clock, progress);
  ready = {};  // frees memory for the meshes
  device.freeBuffers();
  return grown;
}

// Drops what is only needed to write fragments with meshes.
FractureResult finished(FractureResult result, const FractureOptions& options) {
  if (options.surface.meshes) result.surfaces.reset();
  return result;
}

}  // namespace

GrownFracture grown(const TriangleMesh& mesh, const FractureOptions& options, Device& device,
                    const Progress* progress) {
  checkOptions(options);  // before long work
  StageClock clock;
  implOf(device).buildKernels();
  SolidOptions solidOptions = options.solid;
  solidOptions.keepMesh = solidOptions.keepMesh || surfaceOf(options) == Surface::exact;
  solidOptions.keepSeams = solidOptions.keepSeams && options.surface.meshes &&
                           options.surface.surface != Surface::labels;
  Solid solid = voxelize(mesh, solidOptions, progress);
  clock.done("voxelize");
  return grownOf(std::move(solid), options, clock, device, progress);
}

GrownFracture grown(Solid solid, const FractureOptions& options, Device& device,
                    const Progress* progress) {
  return grownOf(std::move(solid), options, StageClock(), device, progress);
}

FractureResult fracture(const TriangleMesh& mesh, const FractureOptions& options, Device& device,
                        const Progress* progress) {
  return finished(extracted(grown(mesh, options, device, progress), options, progress), options);
}

FractureResult fracture(Solid solid, const FractureOptions& options, Device& device,
                        const Progress* progress) {
  return finished(extracted(grown(std::move(solid), options, device, progress), options, progress),
                  options);
}

PreparedSolid prepared(Solid solid, Device& device) {
  VoxelComponents components = findComponents(*solid.blocks, device);
  Solid clean = dropSmallComponents(std::move(solid), components, device);
  auto walls = std::make_shared<SolidWalls>(clean);
  return {std::move(clean),
          std::move(components),
          {},
          std::move(walls),
          std::make_shared<DecidingSolids>()};
}

FractureResult fracture(const PreparedSolid& ready, const FractureOptions& options, Device& device,
                        const Progress* progress) {
  return finished(
      extracted(grow(ready, options, device, StageClock(), progress), options, progress), options);
}

}  // namespace sherd
