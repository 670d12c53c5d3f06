// Estimates the result of a run from a few objects.
#include <sherd/dataset.h>
#include <sherd/error.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <optional>

#include "base/cancel_flag.h"
#include "base/files/unfinished.h"
#include "dataset/assemblage/draw.h"
#include "dataset/journal/object_folder.h"
#include "dataset/layouts/fracture_line.h"
#include "dataset/layouts/identity.h"
#include "dataset/object_run.h"
#include "dataset/output_root.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kSampled = 3;  // objects: small, medium and large
constexpr int kFracturesOfEach = 3;

/// A temporary folder, removed by the destructor.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code absent;
    path_ = (fs::temp_directory_path(absent) / "sherd-forecast-XXXXXX").string();
    if (absent) {
      throw Error(ErrorCode::output,
                  "no folder for temporary files; set TMPDIR to a writable folder");
    }
    const Uncut whole;
    if (::mkdtemp(path_.data()) == nullptr) {
      throw Error(ErrorCode::output, path_ + ": cannot be made");
    }
    unfinished_ = Unfinished(path_, Unfinished::Kind::folder);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  fs::path path() const { return path_; }

 private:
  std::string path_;
  Unfinished unfinished_;
};

struct Cost {
  double seconds = 0.0, bytes = 0.0;
};

/// The cost of an object without fractures, and of one fracture into the fewest and most pieces.
struct ObjectCost {
  Cost once, fewest, most;
};

// The cost of a run with `repeats` fractures into `pieces`.
Cost costOf(const LibraryObject& object, DatasetOptions options, int pieces, int repeats,
            Device& device, const Progress* progress) {
  options.schedule = {pieces, pieces, repeats, repeats, options.schedule.maxFragments};
  const TemporaryFolder folder;
  const fs::path out = folder.path();
  StageSums times;
  const DatasetRun run{out,
                       options,
                       device,
                       [&] { return isCancelled(progress); },
                       [](std::size_t) {},
                       [](const std::string&) {},
                       times};
  const Clock::time_point begin = Clock::now();
  Cost cost;
  {
    Journal journal(out, object);
    runObject(object, journal, run);
  }
  cost.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  for (const Json& line : readJournal(out, object).fractures) {
    for (const FileRecord& file : filesOf(line)) cost.bytes += static_cast<double>(file.bytes);
  }
  return cost;
}

Cost perFracture(const Cost& all, const Cost& once) {
  return {std::max(all.seconds - once.seconds, 0.0) / kFracturesOfEach,
          (all.bytes - once.bytes) / kFracturesOfEach};
}

// Empty for an object that cannot be broken.
std::optional<ObjectCost> measured(const LibraryObject& object, const DatasetOptions& options,
                                   Device& device, const Progress* progress) {
  try {
    const auto run = [&](int pieces, int repeats) {
      return costOf(object, options, pieces, repeats, device, progress);
    };
    const Schedule& schedule = options.schedule;
    (void)run(schedule.fewest, 1);  // warm-up: builds kernels, caches files
    ObjectCost cost;
    cost.once = run(schedule.fewest, 0);
    cost.fewest = perFracture(run(schedule.fewest, kFracturesOfEach), cost.once);
    cost.most = perFracture(run(schedule.most, kFracturesOfEach), cost.once);
    return cost;
  } catch (const Error& e) {
    if (e.code() != ErrorCode::input && e.code() != ErrorCode::usage) throw;
    return std::nullopt;
  }
}

// Picks a small, a medium and a large object.
std::vector<LibraryObject> sampleOf(std::vector<LibraryObject> objects) {
  std::stable_sort(objects.begin(), objects.end(),
                   [](const auto& a, const auto& b) { return a.bytes < b.bytes; });
  if (objects.size() <= kSampled) return objects;
  std::vector<LibraryObject> sample;
  for (std::size_t i = 0; i < kSampled; ++i) {
    sample.push_back(objects[(2 * i + 1) * objects.size() / (2 * kSampled)]);
  }
  return sample;
}

}  // namespace

DatasetForecast forecastDataset(const fs::path& library, const fs::path& out,
                                const DatasetOptions& given, Device& device,
                                const Progress* progress) {
  const DatasetOptions options = checkedOptions(given);
  DatasetForecast forecast;
  std::vector<LibraryObject> found = findObjects(library, options.library, &forecast.skipped);
  requireApart(library, found, out);
  found = plannedObjects(found, options);
  forecast.renamed = renameReserved(options.layout, found);
  const std::vector<LibraryObject> objects = shardOf(found, options.shard);
  forecast.objects = objects.size();
  for (const LibraryObject& object : objects) {
    for (const PlannedFracture& fracture : fracturesOf(object, options)) {
      ++forecast.fractures;
      forecast.fragments += static_cast<std::size_t>(fracture.pieces);
    }
  }
  Cost all;  // of the sampled objects
  for (const LibraryObject& object : sampleOf(objects)) {
    const std::optional<ObjectCost> cost = measured(object, options, device, progress);
    if (!cost) {
      forecast.refused.push_back(object.key);
      continue;
    }
    ++forecast.sampled;
    all.seconds += cost->once.seconds;
    all.bytes += cost->once.bytes;
    const double span = std::max(options.schedule.most - options.schedule.fewest, 1);
    const double several =  // of an assemblage the pieces of all objects
        static_cast<double>(std::max<std::size_t>(object.parts.size() - object.intruders, 1));
    for (const PlannedFracture& fracture : fracturesOf(object, options)) {
      const double at = (fracture.pieces / several - options.schedule.fewest) / span;
      all.seconds += cost->fewest.seconds + at * (cost->most.seconds - cost->fewest.seconds);
      all.bytes += cost->fewest.bytes + at * (cost->most.bytes - cost->fewest.bytes);
    }
  }
  if (forecast.sampled > 0) {
    const double share =
        static_cast<double>(objects.size()) / static_cast<double>(forecast.sampled);
    forecast.seconds = all.seconds * share;
    forecast.bytes = all.bytes * share;
  }
  return forecast;
}

}  // namespace sherd
