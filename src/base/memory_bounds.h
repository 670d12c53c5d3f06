// The bounds of this process's memory.
#pragma once

#include <filesystem>

namespace sherd {

/// Bytes left by each bound; infinity without a bound.
struct MemoryBounds {
  double machine = 0.0;    ///< free without swapping
  double groups = 0.0;     ///< by cgroups, as Slurm and containers set them
  double addresses = 0.0;  ///< by RLIMIT_AS (ulimit -v)
};

/// Returns the bounds of which freeMemory() is the minimum.
[[nodiscard]] MemoryBounds memoryBounds();

/// Returns what the nested cgroups of this process may still use, v2's and v1's; cached file pages
/// count as free.  Infinity without a limit.
///   root  of the file system that has proc/self/cgroup and sys/fs/cgroup
///   source  Linux, Documentation/admin-guide/cgroup-v1/memory.rst and cgroup-v2.rst
[[nodiscard]] double leftByGroups(const std::filesystem::path& root);

}  // namespace sherd
