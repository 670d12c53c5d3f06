// Samples the resources of a run every second.
#pragma once

#include <sherd/device.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

namespace sherd {

struct ResourceSample {
  double seconds = 0.0;            ///< since the beginning
  double cores = 0.0;              ///< mean number of busy ones since the previous sample
  std::uint64_t memory = 0;        ///< resident bytes
  std::uint64_t deviceMemory = 0;  ///< bytes in device buffers
};

/// Samples this process once a second in a background thread.
class ResourceSampler {
 public:
  explicit ResourceSampler(const Device& device);
  ~ResourceSampler();
  ResourceSampler(const ResourceSampler&) = delete;
  ResourceSampler& operator=(const ResourceSampler&) = delete;

  /// Takes a last sample, stops, and returns all; empty on a second call.
  [[nodiscard]] std::vector<ResourceSample> finish();

 private:
  void work();
  void sample();

  const Device& device_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double lastSeconds_ = 0.0, lastCpu_ = 0.0;
  std::vector<ResourceSample> samples_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool done_ = false;  // finish() was called
  std::thread thread_;
};

/// Returns the peak resident memory of this process, bytes.
[[nodiscard]] std::uint64_t peakMemory();

}  // namespace sherd
