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
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>

#include "base/little_endian.h"
#include "base/uncancelled.h"
#include "dataset/growth_ahead.h"
#include "dataset/index.h"
#include "dataset/journal/object_folder.h"
#include "dataset/layouts/fracture_line.h"
#include "dataset/layouts/hdf5_part.h"
#include "dataset/layouts/layout.h"
#include "dataset/layouts/pfpp.h"
#include "dataset/layouts/split_of.h"
#include "dataset/report/thumbnails.h"
#include "dataset/stored_object.h"
#include "folder/files/fracture_files.h"
#include "folder/files/viewer_file.h"
#include "folder/files/write_memory.h"
#include "folder/manifest/input_bodies.h"
#include "folder/manifest/mesh_report.h"
#include "folder/manifest/rounding.h"
#include "formats/arrays/npz.h"
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
  std::shared_ptr<StagedFiles> files;
  Json line;
  std::size_t fragments = 0;
  std::string surfaceWarning, crossingsWarning, aloneWarning;  // a clause, or empty
};

class ObjectRun {
 public:
  ObjectRun(const LibraryObject& object, Journal& journal, const DatasetRun& run)
      : object_(object), journal_(journal), run_(run), options_(run.options) {}

  void execute() {
    try {
      breakObject();
    } catch (const Error& e) {
      if (e.code() != ErrorCode::cancelled || run_.cancelled()) throw;
      std::array<char, 32> seconds{};
      std::snprintf(seconds.data(), seconds.size(), "%g", options_.objectTimeout);
      throw Error(
          ErrorCode::input,
          std::string("took longer than the ") + seconds.data() + " s that an object may take",
          OptionNames{"object-timeout"});
    }
  }

 private:
  void breakObject() {
    SourceMesh source = timed("read", [&] { return read(); });
    if (options_.each.recenter) {
      const glm::dvec3 offset = boxCenter(source.mesh);
      source.mesh = moved(std::move(source.mesh), -offset);
      options_.each.write.offset = offset;
    }
    if (!journal_.text().sha256.empty() && journal_.text().sha256 != source.sha256)
      journal_.clear();
    store_.emplace(storeOf(run_.out, object_, options_, journal_.files(), journal_.archiveBytes()),
                   maxQueuedBytes());
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

  SourceMesh read() {
    if (!isVolumeName(object_.file))
      return readMesh(object_.file, {.maxMemory = options_.maxMemory}, &progress_);
    VolumeOptions options;
    options.maxMemory = options_.maxMemory;
    options.ownVoxels = false;  // all objects of a library have one resolution
    return std::move(readVolume(object_.file, options, &progress_).source);
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
        heldBytes());
    PreparedSolid ready = timed("voxelize", [&] {
      SolidOptions own = base.solid;
      own.objects = source.objectOfTriangle;
      return prepared(voxelize(source.mesh, own, &progress_), run_.device);
    });
    base.solid.voxelSize = ready.solid.frame.voxelSize;
    memory_ = estimatedMemory(source.mesh, base) + sampleMemory(write, base.pieces, heldBytes());
    if (keepsIntactSurface(ready.solid)) ready.surface = intactSurface(ready.solid);
    const FractureWriter writer(source, options_.each.write, options_.layout == DatasetLayout::bb);
    source_ = &source;
    ready_ = &ready;
    writer_ = &writer;
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

  NamedObject named(const FractureOptions& options) const {
    return {object_,
            splitOf(object_.key, options_.split),
            *source_,
            writer_->materials(),
            options,
            options_.each.write,
            ready_->solid.box.longestSide()};
  }

  // Writes the intact object as a fracture of one fragment.
  void writeIntactObject() {
    const Solid& solid = ready_->solid;
    FractureOptions options = optionsFor(options_.each.fracture, options_.each.write);
    options.pieces = 1;
    options.surface.meshes = true;
    FractureResult whole;
    whole.solid = solid;
    whole.components = ready_->components.count();
    whole.labels.blocks = solid.blocks;
    whole.labels.fragmentCount = 1;
    whole.labels.fragment.assign(solid.blocks->count() * 512, 0);
    const auto label = [&](const std::vector<std::uint64_t>& mask, std::uint16_t with) {
      for (std::size_t voxel = 0; voxel < whole.labels.fragment.size(); ++voxel) {
        if ((mask[voxel / 64] >> (voxel % 64)) & 1) whole.labels.fragment[voxel] = with;
      }
    };
    label(solid.blocks->inside, 1);
    label(solid.blocks->exteriorBand, 1);
    whole.fragments = extractFragments(
        solid, whole.labels, {.surface = options.surface, .intact = ready_->surface}, &progress_);
    whole.eroded = {0, 0};
    renderThumbnail(kWholeName, whole);
    label(solid.blocks->inside, Labels::kEroded);  // inside the solid, but in no fragment
    keepDecimated(whole);
    const NamedFiles names = wholeNames(options_.layout, named(options));
    const std::shared_ptr<StagedFiles> files = store_->stage(names.prefix);
    const bool isUnit =
        options_.layout == DatasetLayout::bb || options_.layout == DatasetLayout::hdf5;
    if (isUnit) intoUnitBox(whole);
    making(*files, [&] {
      if (options_.layout == DatasetLayout::hdf5) {
        writeHdf5Part(OutputFile(*files, names.files.mesh[0][0]), hdf5WholeArrays(whole));
      } else if (options_.layout != DatasetLayout::pfpp) {
        writer_->write(*files, names.files, options, whole, &progress_);
      }
    });
    FractureLine line(kWholeName, {0, 0}, options.seed, 0, {});
    if (isInWorld()) line.setOffset(options_.each.write.offset);
    line.addFragments(whole, names.files, *files, options_.poses);
    keep(files, line.json());
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
      keep(std::move(work->files), std::move(work->line));
      warnOfFirst(work->surfaceWarning, hasWarnedOfSurface_);
      warnOfFirst(work->crossingsWarning, hasWarnedOfCrossings_);
      warnOfFirst(work->aloneWarning, hasWarnedOfAlone_);
      run_.fractured(work->fragments);
    };
    using Mode = tbb::filter_mode;
    tbb::parallel_pipeline(
        maxInFlight(),
        tbb::make_filter<void, std::shared_ptr<Work>>(Mode::serial_in_order, growNext) &
            tbb::make_filter<std::shared_ptr<Work>, std::shared_ptr<Work>>(Mode::parallel, finish) &
            tbb::make_filter<std::shared_ptr<Work>, void>(Mode::serial_in_order, record));
  }

  // Warns once for an object, of its first fracture that has the warning.
  void warnOfFirst(const std::string& warning, bool& hasWarned) {
    if (warning.empty() || std::exchange(hasWarned, true)) return;
    run_.warning(object_.file.string() + ": " + warning);
  }

  // Bytes in memory for each byte of a fragment's file: loose files are compressed whole, and pfpp
  // has the points of up to kPfppParts fragments in one file.
  std::uint64_t heldBytes() const {
    if (options_.layout == DatasetLayout::pfpp) return kPfppParts + 1;
    const bool isLoose = options_.layout != DatasetLayout::packed;
    return isLoose && options_.compression != FileCompression::none ? 2 : 0;
  }

  // Bridges stalls of the disk; small beside the memory of fractures.
  std::size_t maxQueuedBytes() const {
    constexpr std::uint64_t kMost = std::uint64_t{64} << 20;
    return static_cast<std::size_t>(std::min(kMost, options_.maxMemory / 8));
  }

  // One more than the threads keeps them busy while a fracture is recorded.
  std::size_t maxInFlight() const {
    const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    const std::size_t fit = memory_ > 0 ? options_.maxMemory / memory_ : threads;
    return std::clamp<std::size_t>(fit, 1, threads + 1);
  }

  void finishFragments(Work& work) {
    Clock::time_point begin = Clock::now();
    const std::unique_ptr<PlannedGrowth> growth = std::move(work.growth);
    const FractureOptions& options = growth->options;
    const PlannedFracture& planned = growth->planned;
    if (!options.surface.meshes && run_.thumbnails.contains(planned.name())) {
      FractureOptions meshed = options;
      meshed.surface.meshes = true;
      renderThumbnail(planned.name(), extracted(growth->grown, meshed, &progress_));
    }
    begin = Clock::now();
    FractureResult result = extracted(std::move(growth->grown), options, &progress_);
    run_.times.add("extract", secondsSince(begin));
    work.surfaceWarning =
        smoothText(*source_, result.fragments.size(), result.exactFailure, result.smooth);
    if (work.surfaceWarning.empty()) work.surfaceWarning = unitedText(result.united);
    work.aloneWarning = aloneText(result.alone);
    if (options.surface.meshes) renderThumbnail(planned.name(), result);
    begin = Clock::now();
    keepDecimated(result);
    const NamedFiles names =
        fractureNames(options_.layout, named(options), planned, growth->number, result.kept());
    work.files = store_->stage(names.prefix);
    FractureLine line(planned.name(), planned, options.seed, growth->attempt, growth->drawn);
    if (isInWorld()) line.setOffset(options_.each.write.offset);
    line.addFragments(result, names.files, *work.files, options_.poses);
    making(*work.files,
           [&] { writeFiles(*work.files, names.files, options, growth->number, result); });
    record(work, result, options, names);
    work.fragments = result.kept();
    work.line = line.json();
    run_.times.add("write", secondsSince(begin) - work.files->packing());
  }

  // Writes the manifest, if the layout has one, and finds triangles that cross each other in files
  // of single precision.
  void record(Work& work, const FractureResult& result, const FractureOptions& options,
              const NamedFiles& names) const {
    const WriteOptions& write = options_.each.write;
    const bool mayCross = isInWorld() && isExact(options, result) && writesFloats(write);
    if (names.manifest.empty() && !mayCross) return;
    const InputBodies bodies = inputBodies(result, options);
    const std::vector<MeshFacts> facts = meshFacts(result, bodies);
    if (mayCross) work.crossingsWarning = crossingsWarning(facts, write);
    if (names.manifest.empty()) return;
    OutputFile(*work.files, names.manifest)
        .write(manifestText(*source_, options, result, facts, bodies, names.files, write));
  }

  // An HDF5 file has one mesh of each fragment: the decimated one, if there is one.
  void keepDecimated(FractureResult& result) const {
    if (options_.layout != DatasetLayout::hdf5) return;
    for (Fragment& fragment : result.fragments) {
      if (!fragment.coarse.empty()) fragment.mesh = std::move(fragment.coarse.front());
    }
  }

  // Makes files.  What a format can't hold, such as a .vox of too many voxels, is the object's
  // error, and no output's that would end the run.
  template <class Make>
  static void making(const StagedFiles& files, const Make& make) try {
    make();
  } catch (const Error& e) {
    if (e.code() != ErrorCode::output || files.isDiskAtFault()) throw;
    throw Error(ErrorCode::input, e.what(), e.options());
  }

  // Writes a fracture as its layout has it.
  void writeFiles(StagedFiles& files, const FractureFiles& names, const FractureOptions& options,
                  std::size_t number, FractureResult& result) const {
    const std::string name = "fractured_" + std::to_string(number);
    switch (options_.layout) {
      case DatasetLayout::hdf5:
        intoUnitBox(result);
        writeHdf5Part(OutputFile(files, names.mesh[0][0]), hdf5Arrays(result, options_.removal));
        return;
      case DatasetLayout::pfpp: {
        const auto [center, scale] = unitBox();
        const PfppFracture fracture{pfppId(object_, number),
                                    objectFolder(DatasetLayout::bb, object_) + "/" + name,
                                    options.seed,
                                    options_.each.write.points,
                                    center,
                                    scale};
        return writePfpp(files, {names.points[0][0], names.correspondences}, fracture, result);
      }
      case DatasetLayout::bb:
        intoUnitBox(result);
        writer_->write(files, names, options, result, &progress_);
        if (options_.each.write.mesh) writeNeighbors(result, options, name, files);
        return;
      default:
        for (const std::string& warning :
             writer_->write(files, names, options, result, &progress_)) {
          warnOnce(object_.key + ": " + warning);
        }
    }
  }

  // Fractures of an object are written in parallel, and mostly have the same warnings.
  void warnOnce(const std::string& warning) const {
    const std::lock_guard lock(warnedMutex_);
    if (warned_.insert(warning).second) run_.warning(warning);
  }

  void renderThumbnail(const std::string& name, const FractureResult& result) const {
    if (!run_.thumbnails.contains(name)) return;
    const Clock::time_point begin = Clock::now();
    writeThumbnail(run_.out / thumbnailName(object_, name),
                   std::span(result.fragments).first(result.kept()), writer_->coordinates().up);
    if (options_.viewers && name != kWholeName) writePage(name, result);
    run_.times.add("picture", secondsSince(begin));
  }

  void writePage(const std::string& name, const FractureResult& result) const {
    std::vector<SurfaceAttributes> attributes;
    for (std::size_t i = 0; writer_->attributes() != nullptr && i < result.kept(); ++i) {
      attributes.push_back(writer_->attributes()->transferTo(result.fragments[i].mesh,
                                                             writer_->materials().inside()));
    }
    writeViewer(run_.out / viewerName(object_, name), *writer_, result, attributes, kMaxViewerBytes,
                &progress_);
  }

  // Writes the neighbor of each face, in folders that no loader reads as fragments.
  static void writeNeighbors(const FractureResult& result, const FractureOptions& options,
                             const std::string& fracture, StagedFiles& files) {
    const auto write = [&](const TriangleMesh& mesh, const std::string& folder, std::size_t i) {
      NpyArray array{"", "<u2", {mesh.triangles.size()}, {}};
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        storeLittle(array.bytes, mesh.neighborOf(t));
      }
      OutputFile(files, "neighbor/" + folder + fracture + "/piece_" + std::to_string(i) + ".npy")
          .write(npyHeader(array) + array.bytes);
    };
    for (std::size_t i = 0; i < result.kept(); ++i) {
      const Fragment& fragment = result.fragments[i];
      write(fragment.mesh, "", i);
      for (std::size_t k = 0; k < fragment.coarse.size(); ++k) {
        const std::string most = std::to_string(options.surface.triangles[k]);
        write(fragment.coarse[k], "decimated_" + most + "/", i);
      }
    }
  }

  // Records the fracture in the journal once its files are stored.
  void keep(std::shared_ptr<StagedFiles> files, Json line) {
    store_->keep(std::move(files), [this, line = std::move(line)](KeptFiles kept) mutable {
      line["files"] = jsonOf(kept.files);
      run_.times.add("store", kept.seconds);
      line["archive"] = kept.archiveBytes;
      journal_.add(line);
    });
  }

  // Whether files have the positions of the object, and are not in a frame of the layout's own.
  bool isInWorld() const {
    return options_.layout == DatasetLayout::sherd || options_.layout == DatasetLayout::packed ||
           options_.layout == DatasetLayout::paper;
  }

  // Breaking Bad's frame: longest side 1, center of the box at 0.  A shell reaches half of its
  // thickness beyond the mesh.
  std::pair<glm::dvec3, double> unitBox() const {
    const Box box = bounds(source_->mesh);
    const double side = longestSide(box) + ready_->solid.report.shellThickness;
    return {(box.min + box.max) / 2.0, 1.0 / side};
  }

  // Points are of the meshes then, which have moved.
  void intoUnitBox(FractureResult& result) const {
    result.surfaces.reset();
    result.unmerged.reset();
    const auto [center, scale] = unitBox();
    const auto move = [center = center, scale = scale](TriangleMesh& mesh) {
      for (glm::dvec3& v : mesh.vertices) v = (v - center) * scale;
    };
    for (Fragment& fragment : result.fragments) {
      move(fragment.mesh);
      for (TriangleMesh& coarse : fragment.coarse) move(coarse);
    }
  }

  const LibraryObject& object_;
  Journal& journal_;
  const DatasetRun& run_;
  DatasetOptions options_;
  Clock::time_point begin_ = Clock::now();
  Progress progress_{.report = {}, .cancelled = [this] {
                       return run_.cancelled() || secondsSince(begin_) > options_.objectTimeout;
                     }};
  std::optional<ObjectStore> store_;
  const SourceMesh* source_ = nullptr;
  const PreparedSolid* ready_ = nullptr;
  const FractureWriter* writer_ = nullptr;
  std::map<std::string, int> done_;  // attempt of each finished fracture, by name
  std::uint64_t memory_ = 0;
  bool hasWarnedOfSurface_ = false, hasWarnedOfCrossings_ = false, hasWarnedOfAlone_ = false;
  mutable std::mutex warnedMutex_;
  mutable std::set<std::string> warned_;
};

}  // namespace

void runObject(const LibraryObject& object, Journal& journal, const DatasetRun& run) {
  ObjectRun(object, journal, run).execute();
}

}  // namespace sherd
