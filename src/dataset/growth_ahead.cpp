// Grows fractures ahead of their extraction.
#include "dataset/growth_ahead.h"

#include <sherd/error.h>
#include <sherd/options.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "dataset/layouts/identity.h"

namespace sherd {

FractureOptions optionsOfFracture(const DatasetOptions& options, int pieces, std::uint64_t seed,
                                  const std::optional<glm::dvec3>& offset, DrawnValues& drawn) {
  RunOptions each = options.each;
  for (const DrawnOption& option : options.drawn) {
    drawn.emplace_back(option.name, option.valueFor(seed));
    fractureOption(option.name)->value.set(each, drawn.back().second);
  }
  if (offset) each = recentered(std::move(each), *offset);
  each.fracture.surface.surface = surfaceOfDataset(each.fracture);
  FractureOptions own = optionsFor(each.fracture, each.write);
  if (options.layout == DatasetLayout::bb) own.surface.meshes = true;  // to scale them
  own.pieces = pieces;
  own.seed = seed;
  return own;
}

GrowthAhead::GrowthAhead(const PreparedSolid& ready, std::string sha256,
                         std::map<std::string, int> done, const DatasetRun& run,
                         const std::optional<glm::dvec3>& offset, const Progress& progress)
    : ready_(ready),
      run_(run),
      options_(run.options),
      sha256_(std::move(sha256)),
      done_(std::move(done)),
      offset_(offset),
      progress_(progress),
      planned_(fracturesOf(run.options.schedule)) {}

std::unique_ptr<PlannedGrowth> GrowthAhead::next() {
  if (ahead_.empty()) {
    const auto begin = std::chrono::steady_clock::now();
    options_.distinct > 0.0 ? growDistinct() : growBatch();
    run_.times.add("grow",
                   std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  if (ahead_.empty()) return nullptr;
  auto first = std::move(ahead_.front());
  ahead_.pop_front();
  return first;
}

// Fractures of a batch share kernel launches and uploads.  On a CPU the gain is small, and a
// fracture whose cut-off components regrow delays the whole batch.
std::size_t GrowthAhead::batchSize() const {
  if (!options_.drawn.empty()) return 1;  // growth options may differ
  const std::size_t maxBatch = run_.device.info().gpu ? 16 : 2;
  const std::size_t maxLeaves = std::size_t{1} << (run_.device.info().gpu ? 17 : 14);
  const std::size_t leaves = std::max<std::size_t>(ready_.solid.blocks->count(), 1);
  return std::clamp<std::size_t>(maxLeaves / leaves, 1, maxBatch);
}

// Grows the next fractures that are not done.
void GrowthAhead::growBatch() {
  std::vector<FractureOptions> options;
  for (; next_ < planned_.size() && ahead_.size() < batchSize(); ++next_) {
    if (done_.contains(planned_[next_].name())) continue;
    ahead_.push_back(planOf(next_, 0));
    options.push_back(ahead_.back()->options);
  }
  if (ahead_.empty()) return;
  std::vector<GrownFracture> grown =
      growTogether(ready_, options, run_.device, StageClock(), &progress_);
  for (std::size_t i = 0; i < grown.size(); ++i) ahead_[i]->grown = std::move(grown[i]);
}

// Grows the next fracture that differs from all before.
void GrowthAhead::growDistinct() {
  for (; next_ < planned_.size() && ahead_.empty(); ++next_) {
    const auto done = done_.find(planned_[next_].name());
    const bool isDone = done != done_.end();
    for (int attempt = isDone ? done->second : 0;; ++attempt) {
      auto plan = planOf(next_, attempt);
      plan->grown = grow(ready_, plan->options, run_.device, StageClock(), &progress_);
      const bool isNew = distinct_.add(plan->grown.result.labels, options_.distinct, isDone);
      if (isNew) {
        if (!isDone) ahead_.push_back(std::move(plan));
        break;
      }
      if (attempt + 1 >= options_.tries) {
        throw Error(ErrorCode::input,
                    "no fracture into " + std::to_string(plan->planned.pieces) +
                        " pieces differs enough from the others in " +
                        std::to_string(options_.tries) +
                        " tries; accept fractures that differ less",
                    OptionNames{"distinct"});
      }
    }
  }
}

std::unique_ptr<PlannedGrowth> GrowthAhead::planOf(std::size_t number, int attempt) {
  auto plan = std::make_unique<PlannedGrowth>();
  plan->planned = planned_[number];
  plan->number = number;
  plan->attempt = attempt;
  const std::uint64_t seed = fractureSeed(options_.seed, sha256_, plan->planned, attempt);
  plan->options = optionsOfFracture(options_, plan->planned.pieces, seed, offset_, plan->drawn);
  plan->options.grow.tuning.warmUp = !std::exchange(warmedUp_, true);
  return plan;
}

}  // namespace sherd
