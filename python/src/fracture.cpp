// A fracture whose fragments are made when they are first read.
#include "fracture.h"

#include <sherd/error.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "base/memory.h"
#include "base/uncancelled.h"
#include "points/sample_surface.h"
#include "process.h"
#include "surface/smooth.h"

namespace pysherd {

using sherd::Error;
using sherd::ErrorCode;
using sherd::FractureOptions;
using sherd::Fragment;
using sherd::Progress;

namespace {

std::vector<std::size_t> pointCounts(const std::vector<Fragment>& fragments, std::size_t count,
                                     const PointChoice& choice) {
  if (!choice.isShared) return std::vector<std::size_t>(count, choice.points.count);
  std::vector<double> areas;
  for (std::size_t i = 0; i < count; ++i) areas.push_back(fragments[i].area);
  return sherd::shareOut(choice.points.count, areas);
}

}  // namespace

std::vector<sherd::SurfacePoints> Fracture::points(PointChoice choice, const Progress& progress) {
  choice.points.seed = seed();
  sherd::checkPointOptions(choice.points);
  preparePoints(progress);
  const std::vector<std::size_t> counts = pointCounts(measured(progress), count(), choice);
  std::vector<sherd::SurfacePoints> points(count());
  sherd::reportProgress(&progress, "points", 0.0);
  tbb::parallel_for(std::size_t{0}, count(), [&](std::size_t i) {
    if (counts[i] == 0 || progress.cancelled()) return;
    sherd::PointOptions options = choice.points;
    options.count = counts[i];
    sherd::uncancelled(
        [&] { points[i] = pointsOf(i, pointOptionsOf(options, static_cast<int>(i) + 1)); });
  });
  sherd::reportProgress(&progress, "points", 1.0);
  return points;
}

sherd::GridFrame GrownPieces::frame() const {
  const sherd::Solid& solid = grown_.result.solid;
  sherd::GridFrame frame = solid.frame;
  frame.origin = frame.worldFromIndex(solid.box.min);
  return frame;
}

VoxelIds GrownPieces::labels() const {
  const sherd::Solid& solid = grown_.result.solid;
  const std::vector<std::uint16_t>& all = grown_.result.labels.fragment;
  VoxelIds voxels{solid.box.dims(), {}};
  const auto side = [&](int axis) { return static_cast<std::size_t>(voxels.dims[axis]); };
  const std::size_t size = side(0) * side(1) * side(2);
  sherd::requireMemory("a dense array of the labels", size * sizeof(std::uint16_t),
                       sherd::freeMemory());
  voxels.ids.assign(size, 0);
  const auto last = static_cast<std::uint16_t>(count());
  solid.blocks->forEachInside([&](std::size_t voxel) {
    const openvdb::Coord at = solid.blocks->voxelAt(voxel) - solid.box.min;
    const std::size_t index =
        (static_cast<std::size_t>(at.x()) * side(1) + static_cast<std::size_t>(at.y())) * side(2) +
        static_cast<std::size_t>(at.z());
    voxels.ids[index] = all[voxel] <= last ? all[voxel] : kNoFragment;
  });
  return voxels;
}

sherd::SurfaceOptions GrownPieces::surface(bool meshes) const {
  sherd::SurfaceOptions options = run_.fracture.surface;
  options.levelSets = false;
  options.meshes = meshes;
  return options;
}

const std::vector<Fragment>& GrownPieces::measured(const Progress& progress) {
  if (!canLackMeshes(surface(false))) return meshed(progress);
  const std::lock_guard lock(making_);
  if (!isMeasured_) {
    measureFragments(grown_, grown_.result, &progress);
    isMeasured_ = true;
  }
  return grown_.result.fragments;
}

const std::vector<Fragment>& GrownPieces::meshed(const Progress& progress) {
  const std::lock_guard lock(making_);
  if (!meshed_) {
    meshed_ = extractAll(grown_.result.solid, grown_.result.labels,
                         grown_.extractOptions(surface(true)), &progress);
  }
  return meshed_->fragments;
}

std::string GrownPieces::exactFailure() const {
  const std::lock_guard lock(making_);
  return meshed_ ? meshed_->exactFailure : std::string();
}

sherd::SurfacePoints GrownPieces::pointsOf(std::size_t i, const sherd::PointOptions& options) {
  const sherd::FractureResult& result = grown_.result;  // nothing changes it any more
  if (!result.surfaces) {
    const Fragment& fragment = meshed_->fragments[i];
    return fragment.cutFaces.empty() ? samplePoints(fragment.mesh, options)
                                     : samplePoints(uncut(fragment), options);
  }
  return samplePoints(result.surfaces->byArea(static_cast<std::uint16_t>(i + 1)), options);
}

std::vector<std::string> GrownPieces::save(const std::string& folder,
                                           const sherd::WriteOptions& write,
                                           const Progress& progress) {
  const FractureOptions options = optionsFor(run_.fracture, write);
  checkWriteOptions(write, options);
  if (write.cost && grown_.result.labels.cost.empty()) {
    throw Error(ErrorCode::usage,
                "write: the arrival costs were not kept; give write to fracture() too");
  }
  sherd::checkFractureFolder(folder);
  sherd::GrownFracture copy;
  {
    const std::lock_guard lock(making_);
    copy = grown_;
  }
  copy.result.fragments.clear();  // measured ones, without meshes
  copy.result.surfaces = nullptr;
  const sherd::FractureResult result = extracted(std::move(copy), options, &progress);
  const sherd::WrittenFolder written =
      writeFracture(folder, solid_->source(), options, result, write, &progress);
  std::vector<std::string> warnings = meshWarnings(solid_->source(), result);
  warnings.insert(warnings.end(), written.warnings.begin(), written.warnings.end());
  if (!result.exactFailure.empty()) {
    warnings.push_back(result.exactFailure +
                       ", so fragments have the smooth surface instead of the exact one");
  }
  return warnings;
}

std::vector<std::shared_ptr<GrownPieces>> broken(
    const SolidPtr& solid, const GivenOptions& given,
    const std::vector<std::pair<int, std::uint64_t>>& piecesAndSeeds, const std::string& device,
    const Progress& progress) {
  sherd::RunOptions run = optionsFrom(given);
  run.fracture = optionsFor(run.fracture, run.write);
  if (solid->ownVoxelSize() > 0.0) run.fracture.solid.voxelSize = solid->ownVoxelSize();
  if (run.fracture.surface.surface == sherd::Surface::exact && !solid->solid().mesh) {
    throw Error(ErrorCode::usage,
                "surface: this solid keeps no mesh; give surface='exact' to voxelize() too");
  }
  checkSurfaceOptions(run.fracture.surface);
  std::vector<FractureOptions> options;
  for (const auto& [pieces, seed] : piecesAndSeeds) {
    options.push_back(run.fracture);
    options.back().pieces = pieces;
    options.back().seed = seed;
  }
  // Meshing the intact solid pays from the second fracture on.
  const sherd::PreparedSolid ready = solid->prepared(options.size() > 1);
  std::vector<sherd::GrownFracture> grown;
  {
    LeasedDevice leased(device);
    grown = growTogether(ready, options, *leased, {}, &progress);
  }
  std::vector<std::shared_ptr<GrownPieces>> all;
  for (std::size_t i = 0; i < grown.size(); ++i) {
    sherd::RunOptions own = run;
    own.fracture = options[i];
    GivenOptions ownGiven = given;
    std::erase_if(ownGiven, [](const auto& option) {
      return option.first == "pieces" || option.first == "seed";
    });
    ownGiven.emplace_back("pieces", std::to_string(options[i].pieces));
    ownGiven.emplace_back("seed", std::to_string(options[i].seed));
    all.push_back(freedElsewhere(std::make_unique<GrownPieces>(
        solid, std::move(ownGiven), std::move(own), std::move(grown[i]))));
  }
  return all;
}

}  // namespace pysherd
