// Breaks a whole library.
#include <sherd/dataset.h>
#include <sherd/error.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "base/cancel_flag.h"
#include "base/files/atomic_file.h"
#include "base/files/below_folder.h"
#include "base/files/file_bytes.h"
#include "dataset/assemblage/draw.h"
#include "dataset/assemblage_run.h"
#include "dataset/index.h"
#include "dataset/journal/failure.h"
#include "dataset/journal/object_folder.h"
#include "dataset/journal/own_sums.h"
#include "dataset/layouts/fracture_line.h"
#include "dataset/layouts/hdf5_join.h"
#include "dataset/layouts/identity.h"
#include "dataset/layouts/pfpp.h"
#include "dataset/object_run.h"
#include "dataset/output_root.h"
#include "dataset/replaced_files.h"
#include "dataset/replacement.h"
#include "dataset/report/report.h"
#include "dataset/report/resources.h"
#include "dataset/report/run_record.h"
#include "dataset/report/thumbnails.h"
#include "dataset/stored_object.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// Whether the folder contains anything but temporary files.
bool holdsOthers(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!entry.path().filename().string().starts_with(".sherd-")) return true;
  }
  return false;
}

void makeOutputFolder(const fs::path& out) {
  std::error_code failed;
  fs::create_directories(out, failed);
  if (!failed) return;
  throw Error(ErrorCode::output, out.string() + ": cannot be made: " + reasonOf(failed.value()));
}

// Refuses to go on where an assemblage would be of other objects: they are drawn among all of the
// library.
void requireSameAssemblages(const fs::path& out, const DatasetPlan& before,
                            const DatasetPlan& plan) {
  const auto keys = [](const DatasetPlan& of) {
    std::vector<std::string> all;
    for (const LibraryObject& object : of.objects) {
      if (!object.parts.empty()) all.push_back(object.key);
      for (const LibraryObject& part : object.parts) all.push_back(part.key);
    }
    return all;
  };
  if (keys(before) == keys(plan)) return;
  throw Error(ErrorCode::usage,
              out.string() +
                  ": its assemblages were drawn among other meshes; give the same library, or "
                  "replace it",
              OptionNames{"replace"});
}

// Takes the licenses of an earlier run, where this one states none.
void keepLicenses(const DatasetPlan& before, DatasetPlan& plan) {
  std::map<std::string_view, std::string_view> licenses;
  for (const LibraryObject& object : before.objects) licenses[object.key] = object.license;
  for (LibraryObject& object : plan.objects) {
    const auto found = licenses.find(object.key);
    if (found != licenses.end()) object.license = found->second;
  }
}

// Prepares the folder for this run.
void prepareFolder(const fs::path& out, DatasetPlan& plan, const DatasetOptions& options) {
  if (hasPlan(out)) {
    const DatasetPlan before = readPlan(out);
    if (!isIdentityOf(options, before.text) || before.layout != plan.layout) {
      throw Error(ErrorCode::usage,
                  out.string() +
                      ": contains a dataset of other options, see its "
                      "dataset.json; use the same options or another folder, or "
                      "replace it",
                  OptionNames{"replace"});
    }
    if (!options.resume) {
      throw Error(ErrorCode::usage,
                  out.string() + ": contains this dataset already; resume it, or replace it",
                  OptionNames{"resume", "replace"});
    }
    requireSameAssemblages(out, before, plan);
    if (options.library.licenses.empty()) keepLicenses(before, plan);
    if (readFileBytes(out / kPlanName) != planText(plan)) writePlan(out, plan);
    return;
  }
  const bool isOthers = holdsOthers(out);
  // Another shard may have written the same plan in the meantime.
  if (isOthers && !hasPlan(out)) {
    throw Error(ErrorCode::output,
                out.string() + ": is not empty and no dataset; use an absent or empty folder");
  }
  writePlan(out, plan);
}

class LibraryRun {
 public:
  LibraryRun(const fs::path& out, const DatasetPlan& plan, const DatasetOptions& options,
             Device& device, const DatasetCallbacks& callbacks)
      : out_(out), plan_(plan), options_(options), device_(device), callbacks_(callbacks) {}

  void execute(const std::vector<LibraryObject>& objects) {
    progress_.ofObjects = objects.size();
    for (const LibraryObject& object : objects) {
      progress_.ofFractures += fracturesOf(object, options_).size();
    }
    for (const LibraryObject& object : objects) {
      progress_.object = object.key;
      const std::size_t each = fracturesOf(object, options_).size();
      Journal journal(out_, object);
      if (journal.text().failed && isTriedAgain(*journal.text().failed, object)) journal.clear();
      clearIfLost(object, journal);
      if (journal.text().done || journal.text().failed) {
        progress_.ofFractures -= each;
      } else {
        const std::size_t already = journal.text().fractures.size();
        progress_.ofFractures -= std::min(each, already > 0 ? already - 1 : 0);
        breakOne(object, journal, each);
      }
      ++progress_.objects;
      reportProgress();
    }
    if (deviceError_ && !hasBroken_) throw *deviceError_;
  }

  [[nodiscard]] const DatasetProgress& progress() const { return progress_; }

  /// Objects that were broken, or failed.
  [[nodiscard]] const std::vector<const LibraryObject*>& written() const { return written_; }

  [[nodiscard]] std::vector<StageTime> times() const {
    std::vector<StageTime> all;
    for (const auto& [stage, seconds] : sums_.all()) all.push_back({stage, seconds});
    return all;
  }

 private:
  // An object whose fractures are gone, as their file was cut or removed, is broken again.
  void clearIfLost(const LibraryObject& object, Journal& journal) const {
    if (plan_.layout != DatasetLayout::hdf5 || journal.text().fractures.empty()) return;
    if (hasFractures(out_, object, journal.text(), joined_)) return;
    journal.clear();
    if (callbacks_.warning) {
      callbacks_.warning(object.key + ": its fractures are not whole in " + out_.string() +
                         ", and are made again");
    }
  }

  void breakOne(const LibraryObject& object, Journal& journal, std::size_t each) {
    const auto found = std::lower_bound(
        plan_.objects.begin(), plan_.objects.end(), object,
        [](const LibraryObject& a, const LibraryObject& b) { return a.key < b.key; });
    const auto number = static_cast<std::size_t>(found - plan_.objects.begin());
    const std::set<std::string> thumbnails =
        object.parts.empty()
            ? thumbnailFractures(options_.schedule, number, plan_.objects.size())
            : thumbnailFractures(fracturesOf(object, options_), number, plan_.objects.size());
    const DatasetRun run{out_,
                         options_,
                         device_,
                         [this] { return isCancelled(callbacks_.progress); },
                         [this](std::size_t fragments) {
                           ++progress_.fractures;
                           progress_.fragments += fragments;
                           reportProgress();
                         },
                         [this](const std::string& warning) {
                           if (callbacks_.warning) callbacks_.warning(warning);
                         },
                         sums_,
                         thumbnails};
    try {
      written_.push_back(&object);
      runObject(object, journal, run);
      hasBroken_ = true;
      deviceError_.reset();
    } catch (...) {
      const Error e = objectError(std::current_exception());
      // A device that fails twice in a row is taken for gone.
      const bool isGone = e.code() == ErrorCode::device && deviceError_;
      if (endsRun(e) || isGone) throw e;
      deviceError_.reset();
      if (e.code() == ErrorCode::device) deviceError_ = e;
      fail(object, journal, e, each);
    }
  }

  void fail(const LibraryObject& object, Journal& journal, const Error& reason, std::size_t each) {
    discardStored(storeOf(out_, object, options_));
    device_.freeBuffers();
    journal.fail({reason.what(), sumOfObject(object), isPassing(reason)});
    progress_.ofFractures -= std::min(each, progress_.ofFractures);
    if (callbacks_.failed) callbacks_.failed(object.key, reason);
  }

  void reportProgress() {
    progress_.seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    if (callbacks_.fractured) callbacks_.fractured(progress_);
  }

  const fs::path& out_;
  const DatasetPlan& plan_;
  const DatasetOptions& options_;
  Device& device_;
  const DatasetCallbacks& callbacks_;
  Clock::time_point begin_ = Clock::now();
  const std::vector<JoinedFile> joined_ = joinedFiles(out_);
  StageSums sums_;
  DatasetProgress progress_;
  std::vector<const LibraryObject*> written_;
  bool hasBroken_ = false;            // an object
  std::optional<Error> deviceError_;  // of the last object
};

DatasetSummary summaryOfShard(const DatasetProgress& progress) {
  DatasetSummary summary;
  summary.objects = progress.objects;
  summary.fractures = progress.fractures;
  summary.fragments = progress.fragments;
  summary.complete = false;
  return summary;
}

DatasetSummary runIn(const fs::path& out, const fs::path& library, const DatasetOptions& given,
                     Device& device, const DatasetCallbacks& callbacks) {
  const DatasetOptions options = checkedOptions(given);
  std::vector<std::string> warnings;
  const std::vector<LibraryObject> found = findObjects(library, options.library, &warnings);
  DatasetPlan plan{datasetIdentity(given), plannedObjects(found, options), options.layout,
                   options.split, options.seed};
  const std::size_t skipped = warnings.size();
  requireApart(library, found, out);
  for (std::string& renamed : renameReserved(plan.layout, plan.objects)) {
    warnings.push_back(std::move(renamed));
  }
  if (plan.layout == DatasetLayout::pfpp) requirePfppIds(plan.objects);
  requireNoLinks(out, plan);
  makeOutputFolder(out);
  OutputLock lock(out);
  const OwnSums before = readOwnSums(out);
  prepareFolder(out, plan, given);
  removeOwnSums(out);
  lock.share();
  for (const std::string& warning : warnings) {
    if (callbacks.warning) callbacks.warning(warning);
  }
  ResourceSampler resources(device);
  LibraryRun run(out, plan, options, device, callbacks);
  const auto record = [&](const DatasetSummary& summary) {
    addRun(out, options, device.info(), run.progress(), summary, run.times(), resources.finish());
  };
  DatasetIndex index;
  DatasetSummary& summary = index.summary;
  const std::vector<LibraryObject> objects = shardOf(plan.objects, options.shard);
  try {
    run.execute(objects);
    if (plan.layout == DatasetLayout::hdf5) {
      joinHdf5(out, plan, options.shard, callbacks.progress);
    }
    if (options.shard.of == 1) {
      index = writeIndex(out, plan, callbacks.progress);
      for (const std::string& warning : summary.warnings) {
        if (callbacks.warning) callbacks.warning(warning);
      }
    } else {
      summary = summaryOfShard(run.progress());
    }
  } catch (const Error&) {
    try {
      record({});
    } catch (const Error&) {  // report the first error
    }
    throw;
  }
  record(summary);
  if (options.shard.of == 1) {
    writeReport(out, index.statistics);
    writeOwnSums(out, before, run.written());
  }
  summary.times = run.times();
  summary.skipped = skipped;
  return summary;
}

// Says what the first line of failures.jsonl does; empty if there is none.
std::string firstFailure(const fs::path& out) {
  if (!isOwnFile(out, kFailuresName)) return {};
  const std::string text = readFileBytes(out / kFailuresName);
  const Json line = Json::parse(text.substr(0, text.find('\n')), nullptr, false);
  if (!line.is_object()) return {};
  return "; the first, " + line.value("object", std::string()) + ": " +
         line.value("reason", std::string());
}

void warnOf(const DatasetCallbacks& callbacks, const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) {
    if (callbacks.warning) callbacks.warning(sentence);
  }
}

// A dataset of which no object could be broken replaces none, and is removed.
void requireObjects(const fs::path& out, const DatasetSummary& summary, Replacement& replacement) {
  if (summary.objects > 0) return;
  const std::string reason = firstFailure(replacement.fresh());
  replacement.discard();
  throw Error(ErrorCode::input,
              "no object could be broken, so " + out.string() + " keeps its dataset" + reason);
}

// Makes a dataset beside the one in `out`, then puts it in its place.
DatasetSummary replaceIn(const fs::path& out, const fs::path& library, DatasetOptions given,
                         Device& device, const DatasetCallbacks& callbacks) {
  const DatasetOptions options = checkedOptions(given);
  const std::vector<LibraryObject> found = findObjects(library, options.library);
  DatasetPlan plan{datasetIdentity(given), plannedObjects(found, options), options.layout,
                   options.split, options.seed};
  requireApart(library, found, out);
  (void)renameReserved(plan.layout, plan.objects);  // runIn reports them
  Replacement replacement(out, options.shard.of > 1);
  std::set<std::string> entries{kJournalFolder};
  for (const LibraryObject& object : plan.objects) entries.merge(entriesOfObject(plan, object));
  replacement.requireFree(entries);
  replacement.prepare(plan, plan.text, options.shard.of);
  given.resume = true;
  DatasetSummary summary = runIn(replacement.fresh(), library, given, device, callbacks);
  summary.folder = options.shard.of > 1 ? replacement.fresh() : out;
  if (options.shard.of > 1) return summary;  // the merge puts them in place
  requireObjects(out, summary, replacement);
  if (options.strict && summary.failures > 0) {
    throw Error(ErrorCode::input,
                std::to_string(summary.failures) +
                    (summary.failures == 1 ? " object" : " objects") + " could not be broken, so " +
                    out.string() + " keeps its dataset; " +
                    (replacement.fresh() / kFailuresName).string() +
                    " has the reasons; mend those meshes and run the same command again, or leave "
                    "the option out",
                OptionNames{"strict"});
  }
  if (callbacks.beforeReplacing) callbacks.beforeReplacing(replacement.fresh());
  warnOf(callbacks, replacement.putInPlace());
  return summary;
}

}  // namespace

DatasetSummary runDataset(const fs::path& library, const fs::path& out, const DatasetOptions& given,
                          Device& device, const DatasetCallbacks& callbacks) {
  if (given.replace && given.resume) {
    throw Error(ErrorCode::usage,
                "a dataset is continued or made anew; give one of the two options",
                OptionNames{"resume", "replace"});
  }
  std::vector<std::string> sentences;
  const bool wasPending = finishReplacement(out, sentences);
  warnOf(callbacks, sentences);
  DatasetOptions options = given;
  // The run that was stopped while it put its dataset in place had made it.
  options.resume |=
      wasPending && given.replace && hasPlan(out) && isIdentityOf(given, readPlan(out).text);
  const bool isReplaced = given.replace && !options.resume && hasPlan(out);
  if (isReplaced) return replaceIn(out, library, options, device, callbacks);
  DatasetSummary summary = runIn(out, library, options, device, callbacks);
  summary.folder = out;
  return summary;
}

namespace {

DatasetSummary mergeIn(const fs::path& out, const Progress* progress) {
  const DatasetPlan plan = readPlan(out);
  OutputLock lock(out);
  lock.share();
  const OwnSums before = readOwnSums(out);
  removeOwnSums(out);
  std::string missing;
  std::size_t count = 0;
  for (const LibraryObject& object : plan.objects) {
    const JournalText journal = readJournal(out, object);
    if (journal.done || journal.failed) continue;
    if (count++ == 0) missing = object.key;
  }
  if (count > 0) {
    throw Error(ErrorCode::input,
                out.string() + ": " + std::to_string(count) + " of " +
                    std::to_string(plan.objects.size()) + " objects are not done, the first is " +
                    missing + "; resume the runs of their shards",
                OptionNames{"resume"});
  }
  if (plan.layout == DatasetLayout::hdf5) joinHdf5(out, plan, {}, progress);
  const DatasetIndex index = writeIndex(out, plan, progress);
  writeReport(out, index.statistics);
  writeOwnSums(out, before, {});
  return index.summary;
}

}  // namespace

DatasetSummary mergeDataset(const fs::path& out, const Progress* progress) {
  std::vector<std::string> sentences;
  (void)finishReplacement(out, sentences);
  if (!hasReplacement(out)) {
    DatasetSummary summary = mergeIn(out, progress);
    summary.warnings.insert(summary.warnings.begin(), sentences.begin(), sentences.end());
    return summary;
  }
  Replacement replacement(out, false);
  DatasetSummary summary = mergeIn(replacement.fresh(), progress);
  requireObjects(out, summary, replacement);
  for (std::string& sentence : replacement.putInPlace())
    summary.warnings.push_back(std::move(sentence));
  return summary;
}

}  // namespace sherd
