// What bounds the memory of this process.
#pragma once

namespace sherd {

/// Bytes that are left, infinity where there is no bound.
struct MemoryBounds {
  double machine = 0.0;    ///< free without swapping
  double groups = 0.0;     ///< by cgroup v2, as Slurm and containers set them
  double addresses = 0.0;  ///< by RLIMIT_AS (ulimit -v)
};

/// What freeMemory() is the least of.
[[nodiscard]] MemoryBounds memoryBounds();

}  // namespace sherd
