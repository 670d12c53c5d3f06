// Reads an object, voxelizes it once, and makes all its planned fractures in a pipeline:
//
//     grow ─────────────▶ extract, mesh, sample, write ──▶ store, record
//     in order,             in parallel                    in order
//     in batches
//
// The number of fractures in the pipeline is bounded, and so is memory.
#include "dataset/object_run.h"

#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/fracture.h>
#include <sherd/options.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <type_traits>
#include <utility>

#include "base/uncancelled.h"
#include "dataset/assemblage_run.h"
#include "dataset/fracture_output.h"
#include "dataset/growth_ahead.h"
#include "dataset/layouts/fracture_line.h"
#include "dataset/object_limits.h"
#include "dataset/stored_object.h"
#include "folder/files/write_memory.h"
#include "pipeline/fracture_stages.h"
#include "pipeline/memory_estimate.h"

namespace sherd {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// A fracture in the pipeline.
struct Work {
  std::unique_ptr<PlannedGrowth> growth;
  MadeFracture made;
};

class ObjectRun {
 public:
  ObjectRun(const LibraryObject& object, Journal& journal, const DatasetRun& run)
      : object_(object), journal_(journal), run_(run), options_(run.options) {}

  void execute() {
    limitedInTime(run_, [&] { breakObject(); });
  }

 private:
  void breakObject() {
    SourceMesh source = timed("read", [&] { return readObject(object_, options_, &progress_); });
    if (options_.each.recenter) {
      const glm::dvec3 offset = boxCenter(source.mesh);
      source.mesh = moved(std::move(source.mesh), -offset);
      options_.each.write.offset = offset;
    }
    if (!journal_.text().sha256.empty() && journal_.text().sha256 != source.sha256)
      journal_.clear();
    store_.emplace(storeOf(run_.out, object_, options_, journal_.files(), journal_.archiveBytes()),
                   maxQueuedBytes(options_));
    if (journal_.text().sha256.empty()) journal_.begin(source.sha256);
    breakAll(source);
    journal_.finish(store_->finish());
  }

  template <class Do>
  std::invoke_result_t<Do> timed(const char* stage, const Do& what) {
    const Clock::time_point begin = Clock::now();
    auto result = what();
    run_.times.add(stage, secondsSince(begin));
    return result;
  }

  void breakAll(const SourceMesh& source) {
    for (const std::string& warning : source.warnings) run_.warning(warning);
    FractureOptions base = optionsFor(options_.each.fracture, options_.each.write);
    base.pieces = options_.schedule.most;
    if (base.solid.resolution == kAutoResolution && isVolumeName(object_.file)) {
      base.solid.resolution = kLeastAutoResolution;  // voxels resolve no thinner walls
    }
    requireMemory(source.mesh, base, options_.maxMemory);
    const WriteOptions& write = options_.each.write;
    requireSampleMemory(
        write, base.pieces, options_.maxMemory,
        [&](std::uint64_t enough) {
          return estimatedMemoryWithin(source.mesh, base, MeshesHeld::all, enough);
        },
        heldBytes(options_));
    PreparedSolid ready = timed("voxelize", [&] {
      SolidOptions own = base.solid;
      own.objects = source.objectOfTriangle;
      return prepared(voxelize(source.mesh, own, &progress_), run_.device);
    });
    base.solid.voxelSize = ready.solid.frame.voxelSize;
    memory_ =
        estimatedMemory(source.mesh, base) + sampleMemory(write, base.pieces, heldBytes(options_));
    if (keepsIntactSurface(ready.solid)) ready.surface = intactSurface(ready.solid);
    source_ = &source;
    ready_ = &ready;
    const OutputOf of{object_, source, ready.solid.box.longestSide(), unitBox()};
    output_.emplace(of, journal_, run_, options_, *store_, progress_);
    for (const Json& line : journal_.text().fractures) {
      done_[line.at("fracture")] = line.value("attempt", 0);
    }
    if (!done_.contains(kWholeName)) writeIntactObject();
    breakPlanned();
    run_.device.freeBuffers();
  }

  // Whether the intact solid's surface is meshed once for all fractures.  It takes memory.
  bool keepsIntactSurface(const Solid& solid) const {
    constexpr std::size_t kMaxLeaves = 50'000;
    const SurfaceOptions& surface = options_.each.fracture.surface;
    return surface.surface == Surface::smooth && surface.interface == Interface::shared &&
           solid.blocks->count() <= kMaxLeaves;
  }

  void writeIntactObject() {
    FractureOptions options = optionsFor(options_.each.fracture, options_.each.write);
    options.pieces = 1;
    options.surface.meshes = true;
    output_->writeWhole(wholeResult(*ready_, options, &progress_), options);
  }

  void breakPlanned() {
    GrowthAhead growthAhead(*ready_, journal_.text().sha256, done_, run_,
                            options_.each.write.offset, progress_);
    const auto growNext = [&](tbb::flow_control& control) -> std::shared_ptr<Work> {
      auto work = std::make_shared<Work>();
      uncancelled([&] { work->growth = growthAhead.next(); });
      if (work->growth) return work;
      control.stop();
      return nullptr;
    };
    const auto finish = [&](std::shared_ptr<Work> work) {
      uncancelled([&] { finishFragments(*work); });
      return work;
    };
    const auto record = [&](const std::shared_ptr<Work>& work) {
      output_->keep(std::move(work->made.files), std::move(work->made.line));
      warnOfFirst(work->made.surfaceWarning, hasWarnedOfSurface_);
      warnOfFirst(work->made.crossingsWarning, hasWarnedOfCrossings_);
      warnOfFirst(work->made.aloneWarning, hasWarnedOfAlone_);
      run_.fractured(work->made.fragments);
    };
    using Mode = tbb::filter_mode;
    tbb::parallel_pipeline(
        maxInFlight(options_, memory_),
        tbb::make_filter<void, std::shared_ptr<Work>>(Mode::serial_in_order, growNext) &
            tbb::make_filter<std::shared_ptr<Work>, std::shared_ptr<Work>>(Mode::parallel, finish) &
            tbb::make_filter<std::shared_ptr<Work>, void>(Mode::serial_in_order, record));
  }

  // Warns once for an object, of its first fracture that has the warning.
  void warnOfFirst(const std::string& warning, bool& hasWarned) {
    if (warning.empty() || std::exchange(hasWarned, true)) return;
    run_.warning(object_.file.string() + ": " + warning);
  }

  void finishFragments(Work& work) {
    const std::unique_ptr<PlannedGrowth> growth = std::move(work.growth);
    const FractureOptions& options = growth->options;
    const std::string name = growth->planned.name();
    if (!options.surface.meshes && run_.thumbnails.contains(name)) {
      FractureOptions meshed = options;
      meshed.surface.meshes = true;
      output_->renderThumbnail(name, extracted(growth->grown, meshed, &progress_));
    }
    FractureResult result =
        timed("extract", [&] { return extracted(std::move(growth->grown), options, &progress_); });
    if (options.surface.meshes) output_->renderThumbnail(name, result);
    work.made = output_->made(std::move(result), options,
                              {growth->planned, growth->number, growth->attempt, growth->drawn});
  }

  // Breaking Bad's frame: longest side 1, center of the box at 0.  A shell reaches half of its
  // thickness beyond the mesh.
  UnitBox unitBox() const {
    const Box box = bounds(source_->mesh);
    const double side = longestSide(box) + ready_->solid.report.shellThickness;
    return {(box.min + box.max) / 2.0, 1.0 / side};
  }

  const LibraryObject& object_;
  Journal& journal_;
  const DatasetRun& run_;
  DatasetOptions options_;
  Clock::time_point begin_ = Clock::now();
  Progress progress_{.report = {}, .cancelled = [this] {
                       return run_.cancelled() || secondsSince(begin_) > options_.objectTimeout;
                     }};
  std::optional<FractureOutput> output_;  // before the store, which calls it until the end
  std::optional<ObjectStore> store_;
  const SourceMesh* source_ = nullptr;
  const PreparedSolid* ready_ = nullptr;
  std::map<std::string, int> done_;  // attempt of each finished fracture, by name
  std::uint64_t memory_ = 0;
  bool hasWarnedOfSurface_ = false, hasWarnedOfCrossings_ = false, hasWarnedOfAlone_ = false;
};

}  // namespace

void runObject(const LibraryObject& object, Journal& journal, const DatasetRun& run) {
  if (!object.parts.empty()) return runAssemblage(object, journal, run);
  ObjectRun(object, journal, run).execute();
}

}  // namespace sherd
