// Options for device, threads and memory.
#pragma once

#include <sherd/device.h>
#include <tbb/global_control.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "cli/terminal/command.h"

namespace sherd::cli {

struct MachineOptions {
  std::string device = "auto";
  int threads = 0;                           ///< 0: all cores
  std::optional<std::uint64_t> maxMemory{};  ///< bytes; none: all free memory

  /// Returns the limit in bytes.
  [[nodiscard]] std::uint64_t memory() const;
};

/// Adds --device, --threads and --max-memory.
void addMachineOptions(CLI::App& command, MachineOptions& options);

/// Sets the environment for the device, before the first thread starts.
void prepareDevice(const MachineOptions& options);

/// Prints a warning if results of the device can be wrong.
void warnOfCaveat(const Device& device);

/// Limits the host's threads during its lifetime; null where all cores are allowed.
[[nodiscard]] std::unique_ptr<tbb::global_control> limitedThreads(const MachineOptions& options);

/// Makes malloc reuse freed memory instead of returning it to the system.  Stages and fractures
/// need arrays of similar sizes; returning their pages and clearing new ones takes a tenth of a
/// dataset's run.
void keepFreedMemory();

}  // namespace sherd::cli
