// Free memory, and refusing work that would not fit.
#pragma once

#include <sherd/error.h>

#include <cstdint>
#include <string>

namespace sherd {

/// Returns the bytes that this process can still allocate: the least of what is free without
/// swapping, what RLIMIT_AS leaves, and what the limits of cgroups (set by Slurm and containers)
/// leave.
[[nodiscard]] std::uint64_t freeMemory();

/// Returns Error(usage) "WHAT takes up to 3 GB of memory, and 2 GB may be used".
///   options  those that set the limit, or what the work takes
[[nodiscard]] Error memoryError(const std::string& what, std::uint64_t bytes, std::uint64_t limit,
                                OptionNames options);

/// Refuses work that would not fit.
///   what    the start of the message: "WHAT takes up to 3 GB of memory, ..."
///   throws  Error(usage) `bytes` is above `limit`
void requireMemory(const std::string& what, std::uint64_t bytes, std::uint64_t limit);

/// Refuses a file whose content would not fit: a few bytes may stand for any number of voxels.
///   what    the start of the message, with the file's name
///   throws  Error(input) `bytes` is above `limit`, or above freeMemory()
void requireMemoryOfFile(const std::string& what, std::uint64_t bytes, std::uint64_t limit);

}  // namespace sherd
