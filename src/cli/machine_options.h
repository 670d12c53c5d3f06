// What a run may take of the machine.
#pragma once

#include <tbb/global_control.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "cli/command.h"

namespace sherd::cli {

struct MachineOptions {
  std::string device = "auto";
  int threads = 0;                           ///< 0: all cores
  std::optional<std::uint64_t> maxMemory{};  ///< bytes; none: what is free

  /// Bytes that may be taken.
  [[nodiscard]] std::uint64_t memory() const;
};

/// --device, --threads and --max-memory.
void addMachineOptions(CLI::App& command, MachineOptions& options);

/// Holds the host's work to options.threads as long as it lives; null where all cores may work.
[[nodiscard]] std::unique_ptr<tbb::global_control> limitedThreads(const MachineOptions& options);

/// Keep freed memory for what comes next.  The arrays of one stage are those of the next, and those
/// of one fracture the next one's: to give their pages back each time, and to have them cleared
/// again, takes a tenth of a dataset's run.
void keepFreedMemory();

}  // namespace sherd::cli
