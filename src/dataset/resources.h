// What a run takes of the machine, second by second.
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
  double cores = 0.0;              ///< busy since the sample before
  std::uint64_t memory = 0;        ///< resident bytes
  std::uint64_t deviceMemory = 0;  ///< bytes in device buffers
};

/// Samples this process once a second, from a thread of its own, as long as it lives.
class ResourceSampler {
 public:
  explicit ResourceSampler(const Device& device);
  ~ResourceSampler();
  ResourceSampler(const ResourceSampler&) = delete;
  ResourceSampler& operator=(const ResourceSampler&) = delete;

  /// Take a last sample, and give all away.
  [[nodiscard]] std::vector<ResourceSample> finish();

 private:
  void sample();

  const Device& device_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double lastSeconds_ = 0.0, lastCpu_ = 0.0;
  std::vector<ResourceSample> samples_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool done_ = false;
  std::thread thread_;
};

/// The most memory that this process ever had, resident bytes.
[[nodiscard]] std::uint64_t peakMemory();

}  // namespace sherd
