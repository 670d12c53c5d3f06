// What `sherd doctor` finds out; gathered apart from how it is printed.
#pragma once

#include <sherd/kernel_cache.h>
#include <sys/types.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace sherd::cli {

/// Sections of facts, and what is wrong.  A key that ends in `_bytes` or `_seconds` has that unit;
/// null stands for what there is not.
struct Diagnosis {
  nlohmann::ordered_json sections = nlohmann::ordered_json::object();
  std::vector<std::string> problems;  ///< a sentence each, without a full stop
  bool deviceWorks = false;
};

/// Looks at the OpenCL drivers and runs a growth on the device of that name, in a process of its
/// own: drivers may crash, hang, and end the process.
class DeviceExamination {
 public:
  /// Begin.  To be called before a thread does any work, as it forks.
  explicit DeviceExamination(const std::string& device);
  ~DeviceExamination();
  DeviceExamination(const DeviceExamination&) = delete;
  DeviceExamination& operator=(const DeviceExamination&) = delete;

  /// Wait for its end and add what was found: sections drivers, platforms and self_test.
  ///   throws  Error(cancelled)
  void addTo(Diagnosis& diagnosis);

 private:
  int wait();

  int answer_ = -1;  // files in memory: what it found, one JSON object a line, and what it printed
  int printed_ = -1;
  pid_t child_ = -1;
};

/// Variables that matter to Sherd and its drivers, as they are now.
[[nodiscard]] nlohmann::ordered_json environmentFacts();

/// Add all else: versions, machine, memory, kernel_cache, temporary_folder, assimp.
///   caches  what provideKernelCache returned
void addHostFacts(Diagnosis& diagnosis, const std::vector<KernelCache>& caches);

/// Both ways of printing it.
[[nodiscard]] std::string asText(const Diagnosis& diagnosis);
[[nodiscard]] std::string asJson(const Diagnosis& diagnosis);

}  // namespace sherd::cli
