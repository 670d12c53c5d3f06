// Breaks one object of a library as often as it is planned.
#pragma once

#include <sherd/dataset.h>

#include <atomic>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "dataset/journal.h"

namespace sherd {

/// Seconds by stage, over all threads.
class StageSums {
 public:
  void add(const std::string& stage, double seconds) {
    const std::lock_guard lock(mutex_);
    seconds_[stage] += seconds;
  }
  [[nodiscard]] std::map<std::string, double> all() const {
    const std::lock_guard lock(mutex_);
    return seconds_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, double> seconds_;
};

/// What the objects of a run share.
struct DatasetRun {
  const std::filesystem::path& out;
  const DatasetOptions& options;
  Device& device;
  std::function<bool()> cancelled;
  std::function<void(std::size_t fragments)> fractured;  ///< after each fracture, in order
  std::function<void(const std::string&)> warning;
  StageSums& times;
  std::set<std::string> pictured{};  ///< fractures whose pictures are taken, by name
};

/// Break an object, and note what is done.  What the journal has already is left alone.
///   throws  Error(input) the object cannot be broken; Error(cancelled) on request, or after
///           options.objectTimeout; Error(output)
void runObject(const LibraryObject& object, Journal& journal, const DatasetRun& run);

}  // namespace sherd
