// A fracture whose fragments are made when they are first read.
#include "fracture.h"

#include <sherd/error.h>
#include <sherd/options.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <span>

#include "appearance/source_faces.h"
#include "base/memory.h"
#include "base/memory_gate.h"
#include "base/uncancelled.h"
#include "folder/manifest/mesh_report.h"
#include "points/check_points.h"
#include "points/point_sequence.h"
#include "points/sample_surface.h"
#include "process.h"
#include "remesh/smooth.h"
#include "surface/simplify.h"

namespace pysherd {

using sherd::Error;
using sherd::ErrorCode;
using sherd::FractureOptions;
using sherd::Fragment;
using sherd::Progress;

namespace {

// Returns the points of each fragment; only a total needs their areas.
std::vector<std::size_t> pointCounts(Fracture& fracture, const PointChoice& choice,
                                     const Progress& progress) {
  const std::size_t count = fracture.count();
  if (choice.counts.size() == count) return choice.counts;
  if (!choice.isShared) return std::vector<std::size_t>(count, choice.points.count);
  const std::vector<Fragment>& fragments = fracture.sampled(progress);
  std::vector<double> areas;
  for (std::size_t i = 0; i < count; ++i) areas.push_back(fragments[i].area);
  return sherd::shareOut(choice.points.count, areas);
}

}  // namespace

const std::vector<Fragment>& Fracture::meshed(const Progress& progress) {
  const std::lock_guard lock(making_);
  if (!meshed_) {
    std::vector<Fragment> fragments = made(progress);
    sourceFaces_ = facesOf(fragments);
    handed_.resize(fragments.size());
    meshed_ = std::move(fragments);
  }
  return *meshed_;
}

void Fracture::makeAgain(const Progress& progress) {
  const std::lock_guard making(making_);
  std::vector<Fragment> again = made(progress);
  const std::unique_lock lock(reading_);
  for (std::size_t i = 0; i < again.size(); ++i) (*meshed_)[i].mesh = std::move(again[i].mesh);
  isWhole_ = true;
}

void Fracture::withMeshes(const Progress& progress,
                          const std::function<void(const std::vector<Fragment>&)>& read) {
  const std::vector<Fragment>& all = meshed(progress);
  for (;;) {
    {
      const std::shared_lock lock(reading_);
      if (isWhole_) return read(all);
    }
    makeAgain(progress);
  }
}

const HandedArrays& Fracture::arrays(std::size_t i) {
  HandedArrays& arrays = handed_.at(i);
  if (arrays.vertices) return arrays;
  sherd::TriangleMesh& mesh = meshed_->at(i).mesh;
  const std::unique_lock lock(reading_, std::try_to_lock);
  const bool isMoved = lock.owns_lock() && canBeMadeAgain();
  const auto handed = [isMoved]<class Array>(Array& array) {
    return std::make_shared<Array>(isMoved ? std::move(array) : Array(array));
  };
  if (isMoved) isWhole_ = false;
  arrays = {handed(mesh.vertices), handed(mesh.triangles), handed(mesh.neighbor)};
  arrays.neighbor->resize(arrays.triangles->size(), 0);  // meshes of plain files have no neighbors
  return arrays;
}

namespace {

// Refuses more points than memory holds: as they are sampled, and as arrays.
//   counts  of each fragment
//   return  bytes that are left for sampling them
std::uint64_t memoryForSampling(const std::vector<std::size_t>& counts,
                                sherd::PointOptions options) {
  constexpr std::uint64_t kPerPoint = 2 * 52;
  const std::uint64_t all = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  options.count = counts.empty() ? 0 : *std::max_element(counts.begin(), counts.end());
  const std::uint64_t needed = kPerPoint * all + samplingMemory(options);
  const std::uint64_t free = sherd::freeMemory();
  if (needed > free) {
    throw sherd::memoryError("sampling " + std::to_string(all) + " points on " +
                                 std::to_string(counts.size()) + " fragments",
                             needed, free, sherd::OptionNames{"points"});
  }
  return free - needed;
}

}  // namespace

std::vector<sherd::SurfacePoints> Fracture::points(PointChoice choice, const Progress& progress) {
  choice.points.seed = seed();
  sherd::checkPointOptions(choice.points);
  const std::vector<std::size_t> counts = pointCounts(*this, choice, progress);
  sherd::MemoryGate gate(memoryForSampling(counts, choice.points) / 2);
  std::vector<sherd::SurfacePoints> points(count());
  const auto sampleEach = [&](const auto& surfaceOf) {
    sherd::reportProgress(&progress, "points", 0.0);
    tbb::parallel_for(std::size_t{0}, count(), [&](std::size_t i) {
      if (counts[i] == 0 || progress.cancelled()) return;
      sherd::PointOptions options = choice.points;
      options.count = counts[i];
      sherd::uncancelled([&] {
        const auto id = static_cast<int>(i) + 1;
        const sherd::MemoryGate::Hold memory(gate, samplingMemory(options));
        points[i] = samplePoints(surfaceOf(i), pointOptionsOf(options, id));
        sherd::requireFinite(points[i], id);
      });
    });
    sherd::reportProgress(&progress, "points", 1.0);
  };
  if (const sherd::FragmentSurfaces* const all = surfaces(progress)) {
    sampleEach([&](std::size_t i) { return all->byArea(static_cast<std::uint16_t>(i + 1)); });
  } else {
    withMeshes(progress, [&](const std::vector<Fragment>& whole) {
      sampleEach([&](std::size_t i) { return uncut(whole[i]); });
    });
  }
  return points;
}

sherd::GridFrame GrownPieces::frame() const {
  const sherd::Solid& solid = grown_.result.solid;
  sherd::GridFrame frame = solid.frame;
  frame.origin = frame.worldFromIndex(solid.box.min);
  return frame;
}

VoxelIds GrownPieces::labels(const Progress& progress) {
  const std::lock_guard lock(making_);
  if (!grown_.isSettled) settle(grown_, surface(true), &progress);
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

// Measures fragments by the labels' surfaces, once; false where points are not sampled of these.
bool GrownPieces::measureSurfaces(const Progress& progress) {
  const sherd::SurfaceOptions options = surface(false);
  if (!samplesLabelSurfaces(options)) return false;
  const std::lock_guard lock(making_);
  if (!isMeasured_) measureFragments(grown_, grown_.result, options, &progress);
  isMeasured_ = true;
  return true;
}

// Measures are those of the meshes, which differ from the surfaces before triangles are merged.
const std::vector<Fragment>& GrownPieces::measured(const Progress& progress) {
  if (!canLackMeshes(surface(false))) return meshed(progress);
  const bool isMerged = [&] {
    const std::lock_guard lock(making_);
    if (!isMerged_) {
      isMerged_ = simplificationOf(surface(true), grown_.result.solid, grown_.surface.get())
                      .changesMeshes();
    }
    return *isMerged_;
  }();
  return isMerged ? meshed(progress) : sampled(progress);
}

const std::vector<Fragment>& GrownPieces::sampled(const Progress& progress) {
  return measureSurfaces(progress) ? grown_.result.fragments : meshed(progress);
}

const sherd::FragmentSurfaces* GrownPieces::surfaces(const Progress& progress) {
  return measureSurfaces(progress) ? grown_.result.surfaces.get() : nullptr;
}

std::vector<Fragment> GrownPieces::made(const Progress& progress) {
  settle(grown_, surface(true), &progress);
  sherd::ExtractOptions options = grown_.extractOptions(surface(true));
  std::optional<sherd::ExactSurface> exact;  // that of fragments broken again can't be made anew
  if (grown_.exact) {
    exact = isAgain_ ? *grown_.exact : std::move(*grown_.exact);
    if (!isAgain_) grown_.exact.reset();
    options.exact = &*exact;
  }
  sherd::ExtractedFragments extracted =
      extractAll(grown_.result.solid, grown_.result.labels, options, &progress);
  smoothText_ = sherd::smoothText(solid_->source(), extracted.fragments.size(),
                                  extracted.exactFailure, extracted.smooth);
  unitedText_ = sherd::unitedText(extracted.united);
  return std::move(extracted.fragments);
}

std::vector<std::shared_ptr<std::vector<std::int32_t>>> GrownPieces::facesOf(
    const std::vector<Fragment>& fragments) const {
  const sherd::SourceMesh& source = solid_->source();
  const bool isMesh = !source.mesh.triangles.empty() && !sherd::isVolumeName(source.name);
  if (!run_.write.sourceFaces || !isMesh) return {};
  const sherd::AttributeSource triangles(source.mesh, true);
  std::vector<std::shared_ptr<std::vector<std::int32_t>>> faces;
  for (const Fragment& fragment : fragments) {
    faces.push_back(std::make_shared<std::vector<std::int32_t>>(
        sherd::sourceFaces(fragment.mesh, source, triangles, grown_.result.solid)));
  }
  return faces;
}

std::string GrownPieces::smoothText() const {
  const std::lock_guard lock(making_);
  return smoothText_;
}

std::vector<std::string> GrownPieces::guideWarnings() const {
  std::vector<std::string> all = grown_.result.guideWarnings;
  if (grown_.result.alone > 0) all.push_back(sherd::aloneText(grown_.result.alone));
  return all;
}

std::string GrownPieces::unitedText() const {
  const std::lock_guard lock(making_);
  return unitedText_;
}

sherd::FractureResult GrownPieces::extractedCopy(const FractureOptions& options,
                                                 const Progress& progress) const {
  sherd::GrownFracture copy;
  {
    const std::lock_guard lock(making_);
    copy = grown_;
  }
  copy.result.fragments.clear();  // measured ones, without meshes
  copy.result.surfaces = nullptr;
  copy.result.unmerged = nullptr;
  return extracted(std::move(copy), options, &progress);
}

sherd::FinishedFracture GrownPieces::finished(const Progress& progress) {
  FractureOptions options = optionsFor(run_.fracture, run_.write);
  options.surface.levelSets = options.surface.meshes = true;
  sherd::WriteOptions write = run_.write;
  write.offset = solid_->offset();
  return finishedFracture(solid_->source(), options, extractedCopy(options, progress), write);
}

std::vector<std::string> GrownPieces::save(const std::string& folder, sherd::WriteOptions write,
                                           const Progress& progress) {
  write.offset = solid_->offset();
  const FractureOptions options = optionsFor(run_.fracture, write);
  checkWriteOptions(write, options);
  if (write.cost && grown_.result.labels.cost.empty()) {
    throw Error(ErrorCode::usage,
                "write: the arrival costs were not kept; give write to fracture() too");
  }
  sherd::checkFractureFolder(folder);
  const sherd::FractureResult result = extractedCopy(options, progress);
  const sherd::WrittenFolder written =
      writeFracture(folder, solid_->source(), options, result, write, &progress);
  std::vector<std::string> warnings = meshWarnings(solid_->source(), result);
  warnings.insert(warnings.end(), written.warnings.begin(), written.warnings.end());
  return warnings;
}

namespace {

// Reads the files that options name.
void readGiven(FractureOptions& options, const std::string& mesh, const Progress& progress) {
  const sherd::ReadOptions memory{.maxMemory = sherd::freeMemory()};
  for (sherd::Guide& guide : options.guides) {
    guide = sherd::readGuide(guide.file, memory, &progress);
  }
  sherd::Density& density = options.seeds.density;
  if (!density.source.empty()) {
    density = sherd::readDensity(density.source, mesh, memory, &progress);
  }
}

// The same, and moves positions with a solid that was recentered.
sherd::RunOptions withFiles(sherd::RunOptions run, const Solid& solid, const Progress& progress) {
  checkSurfaceOptions(run.fracture.surface);
  readGiven(run.fracture, solid.file(), progress);
  return solid.offset() ? recentered(std::move(run), *solid.offset()) : run;
}

}  // namespace

std::vector<std::shared_ptr<GrownPieces>> broken(
    const SolidPtr& solid, const GivenOptions& given,
    const std::vector<std::pair<int, std::uint64_t>>& piecesAndSeeds, const std::string& device,
    const Progress& progress) {
  sherd::RunOptions run = optionsFrom(given);
  const bool isChosen = run.fracture.surface.surface != sherd::Surface::automatic;
  if (!isChosen && !solid->solid().mesh) run.fracture.surface.surface = sherd::Surface::smooth;
  run.fracture = optionsFor(run.fracture, run.write);
  if (solid->ownVoxelSize() > 0.0) run.fracture.solid.voxelSize = solid->ownVoxelSize();
  if (run.fracture.surface.surface == sherd::Surface::exact && !solid->solid().mesh) {
    throw Error(ErrorCode::usage,
                "surface: this solid keeps no mesh; give surface='exact' to voxelize() too");
  }
  run = withFiles(std::move(run), *solid, progress);
  std::vector<FractureOptions> options;
  std::vector<GivenOptions> drawn;
  for (const auto& [pieces, seed] : piecesAndSeeds) {
    sherd::RunOptions own = run;
    own.fracture.pieces = pieces;
    own.fracture.seed = seed;
    drawn.push_back(drawnByPreset(given, own));
    options.push_back(std::move(own.fracture));
  }
  // Meshing the intact solid pays from the second fracture on.
  if (options.size() > 1) solid->keepSurface();
  const sherd::PreparedSolid ready = solid->prepared();
  std::vector<sherd::GrownFracture> grown;
  {
    LeasedDevice leased(device);
    // Fractures that grow together have the growth of the first.
    const bool isAnyDrawn = !drawn.empty() && !drawn.front().empty();
    const std::size_t together = isAnyDrawn ? 1 : std::max<std::size_t>(options.size(), 1);
    for (std::size_t first = 0; first < options.size(); first += together) {
      auto some =
          growTogether(ready, std::span(options).subspan(first, together), *leased, {}, &progress);
      std::move(some.begin(), some.end(), std::back_inserter(grown));
    }
  }
  std::vector<std::shared_ptr<GrownPieces>> all;
  for (std::size_t i = 0; i < grown.size(); ++i) {
    sherd::RunOptions own = run;
    own.fracture = options[i];
    GivenOptions ownGiven = given;
    std::erase_if(ownGiven, [](const auto& option) {
      return option.first == "pieces" || option.first == "seed";
    });
    if (!isGiven(given, "seeds")) {  // which have their number
      ownGiven.emplace_back("pieces", std::to_string(options[i].pieces));
    }
    ownGiven.emplace_back("seed", std::to_string(options[i].seed));
    ownGiven.insert(ownGiven.end(), drawn[i].begin(), drawn[i].end());
    all.push_back(freedElsewhere(std::make_unique<GrownPieces>(
        solid, std::move(ownGiven), std::move(own), std::move(grown[i]))));
  }
  return all;
}

GivenOptions optionsAgain(const Fracture& fracture, const GivenOptions& given) {
  sherd::RunOptions run = fracture.inherited();
  if (isGiven(given, "material")) {  // no option of another one stays
    FractureOptions fresh;
    fresh.seed = run.fracture.seed;
    fresh.surface = run.fracture.surface;
    run.fracture = std::move(fresh);
  }
  const std::uint64_t seed = run.fracture.seed;
  run = optionsFrom(given, std::move(run));
  if (!isGiven(given, "seed")) run.fracture.seed = seed;  // presets have one of their own
  return givenOf(run);
}

std::shared_ptr<GrownPieces> brokenAgain(Fracture& fracture, const std::vector<int>& ids,
                                         const GivenOptions& given, const std::string& device,
                                         const Progress& progress) {
  const sherd::FinishedFracture finished = fracture.finished(progress);
  const SolidPtr solid = fracture.solidOf(finished);
  sherd::RunOptions run = optionsFrom(given);
  if (run.fracture.surface.surface == sherd::Surface::automatic && !finished.isExact) {
    run.fracture.surface.surface = sherd::Surface::smooth;
  }
  run.fracture.solid.resolution = finished.resolution;
  run.fracture = optionsFor(run.fracture, run.write);
  run = withFiles(std::move(run), *solid, progress);
  LeasedDevice leased(device);
  sherd::GrownFracture grown = regrown(finished, ids, run.fracture, *leased, &progress);
  return freedElsewhere(
      std::make_unique<GrownPieces>(solid, given, std::move(run), std::move(grown)));
}

}  // namespace pysherd
