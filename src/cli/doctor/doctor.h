// Facts of `sherd doctor`, gathered separately from printing.
#pragma once

#include <sherd/device.h>
#include <sys/types.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sherd::cli {

/// Sections of facts, and problems.  A key that ends in `_bytes` or `_seconds` has that unit; null
/// is an absent fact.
struct Diagnosis {
  nlohmann::ordered_json sections = nlohmann::ordered_json::object();
  std::vector<std::string> problems;  ///< a sentence each, without a full stop
  bool deviceWorks = false;
};

/// Lists the OpenCL drivers and runs a growth on one device, in a separate process: drivers may
/// crash, hang, or end the process.
class DeviceExamination {
 public:
  /// Starts the process.  It forks, so it must be called before any thread starts.
  ///   device  as --device
  explicit DeviceExamination(const std::string& device);
  ~DeviceExamination();
  DeviceExamination(const DeviceExamination&) = delete;
  DeviceExamination& operator=(const DeviceExamination&) = delete;

  /// Waits for the process and adds its sections: drivers, platforms and self_test.
  ///   throws  Error(cancelled)
  void addTo(Diagnosis& diagnosis);

 private:
  int wait();

  int answer_ = -1;  // files in memory: the sections, one JSON object a line, and the output
  int printed_ = -1;
  pid_t child_ = -1;
};

/// Returns the environment variables that affect Sherd and its drivers.
[[nodiscard]] nlohmann::ordered_json environmentFacts();

/// Adds the other sections: versions, machine, memory, kernel_cache, temporary_folder, assimp.
///   caches  result of provideKernelCache
void addHostFacts(Diagnosis& diagnosis, const std::vector<KernelCache>& caches);

/// Returns the output of `sherd doctor`, as text or JSON.
[[nodiscard]] std::string asText(const Diagnosis& diagnosis);
[[nodiscard]] std::string asJson(const Diagnosis& diagnosis);

}  // namespace sherd::cli
