// What the objects of a run share.
#pragma once

#include <sherd/dataset.h>

#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>

namespace sherd {

/// Seconds by stage, summed over all threads.
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

/// The shared context of a run's objects.
struct DatasetRun {
  const std::filesystem::path& out;
  const DatasetOptions& options;
  Device& device;
  std::function<bool()> cancelled;
  std::function<void(std::size_t fragments)> fractured;  ///< after each fracture, in order
  std::function<void(const std::string&)> warning;
  StageSums& times;
  std::set<std::string> thumbnails{};  ///< names of fractures that get a thumbnail
};

}  // namespace sherd
