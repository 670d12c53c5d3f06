// Reads the objects of an assemblage, voxelizes each once, and makes all its planned fractures:
//
//     grow each object ─────▶ extract, put together, write ──▶ store, record
//     in order                in parallel                      in order
#include "dataset/assemblage_run.h"

#include <sherd/error.h>
#include <sherd/fracture.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "base/text/json_of.h"
#include "base/uncancelled.h"
#include "dataset/assemblage/compose.h"
#include "dataset/assemblage/draw.h"
#include "dataset/assemblage/parts.h"
#include "dataset/fracture_output.h"
#include "dataset/growth_ahead.h"
#include "dataset/journal/failure.h"
#include "dataset/layouts/fracture_line.h"
#include "dataset/layouts/layout.h"
#include "dataset/object_limits.h"
#include "dataset/stored_object.h"
#include "folder/files/fracture_files.h"
#include "folder/files/write_memory.h"
#include "pipeline/fracture_stages.h"
#include "seed/fragment_ids.h"

namespace sherd {
namespace {

using Clock = std::chrono::steady_clock;

/// An object of a fracture, grown.
struct GrownPart {
  FractureOptions options;
  DrawnValues drawn;
  GrownFracture grown;
};

/// A fracture in the pipeline.
struct AssemblageWork {
  AssemblageFracture fracture;
  std::size_t number = 0;
  std::uint64_t seed = 0;
  std::vector<GrownPart> parts;
  MadeFracture made;
};

/// An intruder, and the fragment that it is like.
struct Likeness {
  std::size_t only = 0;              // index of the intruder among the fragments of its object
  std::size_t part = 0, target = 0;  // index of the other one
  double ratio = 1.0;                // of the volumes
};

// Chooses the fragment of an intruder's object: the one whose volume is nearest to that of a kept
// fragment of the others, which is drawn.  Where none is within a factor of two, another is drawn.
Likeness likenessOf(const FractureResult& intruder, const std::vector<FracturePart>& parts,
                    std::size_t objects, std::uint64_t seed) {
  std::vector<std::pair<std::size_t, std::size_t>> targets;
  for (std::size_t k = 0; k < objects; ++k) {
    for (std::size_t i = 0; i < parts[k].result.kept(); ++i) targets.emplace_back(k, i);
  }
  std::optional<Likeness> best;
  const auto farness = [](double ratio) { return std::abs(std::log(ratio)); };
  for (const std::uint16_t at : permutedIds(targets.size(), seed)) {
    const auto [part, target] = targets[at - 1u];
    const double wanted = parts[part].result.fragments[target].mass.volume;
    for (std::size_t i = 0; i < intruder.kept(); ++i) {
      const double ratio = intruder.fragments[i].mass.volume / wanted;
      if (best && !(farness(ratio) < farness(best->ratio))) continue;
      best = Likeness{i, part, target, ratio};
    }
    if (best && best->ratio > 0.5 && best->ratio < 2.0) break;
  }
  return best.value_or(Likeness{});
}

class AssemblageRun {
 public:
  AssemblageRun(const LibraryObject& assemblage, Journal& journal, const DatasetRun& run)
      : assemblage_(assemblage), journal_(journal), run_(run), options_(run.options) {}

  void execute() {
    std::vector<SourceMesh> sources;
    std::vector<std::string> sums;
    for (const LibraryObject& part : assemblage_.parts) {
      ofObject(part.key, [&] {
        sources.push_back(timed("read", [&] { return readObject(part, options_, &progress_); }));
      });
      sums.push_back(sources.back().sha256);
      for (const std::string& warning : sources.back().warnings) run_.warning(warning);
    }
    const std::string sum = sumOfSums(sums);
    if (!journal_.text().sha256.empty() && journal_.text().sha256 != sum) journal_.clear();
    store_.emplace(
        storeOf(run_.out, assemblage_, options_, journal_.files(), journal_.archiveBytes()),
        maxQueuedBytes(options_));
    if (journal_.text().sha256.empty()) journal_.begin(sum);
    source_.name = source_.stem = assemblage_.key;
    source_.sha256 = sum;
    prepare(std::move(sources));
    makeAll();
    journal_.finish(store_->finish());
  }

 private:
  template <class Do>
  std::invoke_result_t<Do> timed(const char* stage, const Do& what) {
    const Clock::time_point begin = Clock::now();
    auto result = what();
    run_.times.add(stage, std::chrono::duration<double>(Clock::now() - begin).count());
    return result;
  }

  // Options of fragments that can be put together: with meshes.
  static FractureOptions meshed(FractureOptions options) {
    options.surface.meshes = true;
    options.surface.points = false;
    return options;
  }

  void prepare(std::vector<SourceMesh> sources) {
    FractureOptions base = meshed(optionsFor(options_.each.fracture, options_.each.write));
    base.pieces = options_.schedule.most;
    parts_ = timed("voxelize", [&] {
      return assemblageParts(assemblage_.parts, std::move(sources), base, options_, run_.device,
                             &progress_);
    });
    int side = 0;
    for (const AssemblagePart& part : parts_) {
      memory_ += part.memory;
      side = std::max(side, part.ready.solid.box.longestSide());
    }
    memory_ += sampleMemory(options_.each.write, base.pieces, heldBytes(options_));
    // As in pysherd.torch: the first object around 0, each with a side of 1.
    unitBox_ = {parts_.front().size / 2.0, 1.0};
    const OutputOf of{assemblage_, source_, side, unitBox_};
    output_.emplace(of, journal_, run_, options_, *store_, progress_);
  }

  void makeAll() {
    std::set<std::string> done;
    for (const Json& line : journal_.text().fractures) done.insert(line.at("fracture"));
    if (!done.contains(kWholeName)) writeWhole();
    const std::vector<AssemblageFracture> fractures = assemblageFractures(assemblage_, options_);
    std::size_t next = 0;
    const auto growNext = [&](tbb::flow_control& control) -> std::shared_ptr<AssemblageWork> {
      while (next < fractures.size() && done.contains(fractures[next].planned.name())) ++next;
      if (next == fractures.size()) {
        control.stop();
        return nullptr;
      }
      auto work = std::make_shared<AssemblageWork>();
      work->fracture = fractures[next];
      work->number = next++;
      uncancelled([&] { grow(*work); });
      return work;
    };
    const auto finish = [&](std::shared_ptr<AssemblageWork> work) {
      uncancelled([&] { this->finish(*work); });
      return work;
    };
    const auto record = [&](const std::shared_ptr<AssemblageWork>& work) {
      MadeFracture& made = work->made;
      output_->keep(std::move(made.files), std::move(made.line));
      for (const std::string& warning :
           {made.surfaceWarning, made.crossingsWarning, made.aloneWarning}) {
        const std::string kind = warning.substr(warning.find(' ') + 1);  // whatever the number
        if (!warning.empty() && warned_.insert(kind).second)
          run_.warning(assemblage_.key + ": " + warning);
      }
      run_.fractured(made.fragments);
    };
    using Work = std::shared_ptr<AssemblageWork>;
    using Mode = tbb::filter_mode;
    tbb::parallel_pipeline(maxInFlight(options_, memory_),
                           tbb::make_filter<void, Work>(Mode::serial_in_order, growNext) &
                               tbb::make_filter<Work, Work>(Mode::parallel, finish) &
                               tbb::make_filter<Work, void>(Mode::serial_in_order, record));
    run_.device.freeBuffers();
  }

  void writeWhole() {
    FractureOptions options = meshed(optionsFor(options_.each.fracture, options_.each.write));
    options.pieces = 1;
    std::vector<FractureResult> wholes;
    for (std::size_t k = 0; k < parts_.size() - assemblage_.intruders; ++k) {
      wholes.push_back(wholeResult(parts_[k].ready, options, &progress_));
    }
    output_->writeWhole(composedWhole(std::move(wholes)), options);
  }

  // Grows each object by a seed that `sherd fracture` can be given.
  void grow(AssemblageWork& work) {
    const Clock::time_point begin = Clock::now();
    work.seed = fractureSeed(options_.seed, source_.sha256, work.fracture.planned);
    const std::size_t objects = parts_.size() - assemblage_.intruders;
    for (std::size_t k = 0; k < work.fracture.pieces.size(); ++k) {
      GrownPart& own = work.parts.emplace_back();
      const int pieces = work.fracture.pieces[k];
      const std::uint64_t seed =
          fractureSeed(work.seed, parts_[k].sha256, {pieces, static_cast<int>(k)});
      own.options = meshed(optionsOfFracture(options_, pieces, seed, std::nullopt, own.drawn));
      own.options.solid.voxelSize = parts_[k].ready.solid.frame.voxelSize;
      if (k >= objects) own.options.missing = own.options.dropShare = 0.0;
      ofObject(parts_[k].key, [&] {
        own.grown =
            sherd::grow(parts_[k].ready, own.options, run_.device, StageClock(), &progress_);
      });
    }
    run_.times.add("grow", std::chrono::duration<double>(Clock::now() - begin).count());
  }

  void finish(AssemblageWork& work) {
    const Clock::time_point begin = Clock::now();
    const std::size_t objects = parts_.size() - assemblage_.intruders;
    std::vector<FracturePart> parts;
    std::vector<Likeness> likenesses;
    for (std::size_t k = 0; k < work.parts.size(); ++k) {
      GrownPart& own = work.parts[k];
      ofObject(parts_[k].key, [&] {
        parts.push_back({extracted(std::move(own.grown), own.options, &progress_), kAllKept});
      });
      if (k < objects) continue;
      likenesses.push_back(likenessOf(parts[k].result, parts, objects, own.options.seed));
      parts[k].only = likenesses.back().only;
    }
    ComposedFracture all = composed(std::move(parts), work.seed);
    Json list = Json::array();
    for (std::size_t k = 0; k < work.parts.size(); ++k) {
      Json own = objectJson(parts_[k], work.parts[k]);
      if (k >= objects) {
        const Likeness& like = likenesses[k - objects];
        own["intruder"] = true;
        own["like"] = {{"id", all.newIds[like.part][like.target + 1]}, {"ratio", like.ratio}};
      }
      list.push_back(std::move(own));
    }
    run_.times.add("extract", std::chrono::duration<double>(Clock::now() - begin).count());
    FractureOptions options = work.parts.front().options;
    options.pieces = work.fracture.planned.pieces;
    options.seed = work.seed;
    output_->renderThumbnail(work.fracture.planned.name(), all.result);
    work.made = output_->made(std::move(all.result), options,
                              {work.fracture.planned, work.number, 0, {}, std::move(list)});
  }

  // With the translation of positions in files.
  Json objectJson(const AssemblagePart& part, const GrownPart& grown) const {
    const bool isInWorld = hasWorldPositions(options_.layout);
    Json drawn = Json::object();
    for (const auto& [option, value] : grown.drawn) drawn[option] = value;
    return {{"mesh", part.key},
            {"sha256", part.sha256},
            {"pieces", grown.options.pieces},
            {"seed", grown.options.seed},
            {"options", std::move(drawn)},
            {"scale", part.scale},
            {"translation", jsonOf(isInWorld ? part.translation : unitBox_.of(part.translation))}};
  }

  const LibraryObject& assemblage_;
  Journal& journal_;
  const DatasetRun& run_;
  const DatasetOptions& options_;
  Clock::time_point begin_ = Clock::now();
  Progress progress_{.report = {}, .cancelled = [this] {
                       const std::chrono::duration<double> passed = Clock::now() - begin_;
                       return run_.cancelled() || passed.count() > options_.objectTimeout;
                     }};
  SourceMesh source_;  // of all, without a mesh
  std::vector<AssemblagePart> parts_;
  UnitBox unitBox_;  // of layouts that have one
  std::uint64_t memory_ = 0;
  std::optional<FractureOutput> output_;  // before the store, which calls it until the end
  std::optional<ObjectStore> store_;
  std::set<std::string> warned_;
};

}  // namespace

void runAssemblage(const LibraryObject& assemblage, Journal& journal, const DatasetRun& run) {
  limitedInTime(run, [&] { AssemblageRun(assemblage, journal, run).execute(); });
}

}  // namespace sherd
