// How much memory there is, and refusing what would not fit.
#pragma once

#include <cstdint>
#include <string>

namespace sherd {

/// Bytes that this process can still get: what the machine has free without swapping, and what
/// limits on the process (RLIMIT_AS) and its groups (cgroup v2, as Slurm and containers set them)
/// leave.
[[nodiscard]] std::uint64_t freeMemory();

/// Refuse what would not fit.
///   what    the sentence begins with it: "WHAT takes up to 3 GB of memory, ..."
///   throws  Error(usage) `bytes` are above `limit`
void requireMemory(const std::string& what, std::uint64_t bytes, std::uint64_t limit);

}  // namespace sherd
