// The bounds of this process's memory.
#pragma once

namespace sherd {

/// Bytes left by each bound; infinity without a bound.
struct MemoryBounds {
  double machine = 0.0;    ///< free without swapping
  double groups = 0.0;     ///< by cgroup v2, as Slurm and containers set them
  double addresses = 0.0;  ///< by RLIMIT_AS (ulimit -v)
};

/// Returns the bounds of which freeMemory() is the minimum.
[[nodiscard]] MemoryBounds memoryBounds();

}  // namespace sherd
