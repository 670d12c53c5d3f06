// The memory that samples take while they are written.
#pragma once

#include <sherd/options.h>

#include <cstdint>
#include <functional>

namespace sherd {

/// Returns the bytes that points, distance samples and correspondences of a fracture take at most,
/// beside what the fracture takes without them.
///   held  bytes in memory for each byte of a file that is written, as a sink that compresses whole
///         files holds them
[[nodiscard]] std::uint64_t sampleMemory(const WriteOptions& write, int pieces,
                                         std::uint64_t held = 0);

/// Refuses samples that would not fit.
///   fracture  returns an estimate of the rest, which may be higher than needed up to `enough`
///   throws    Error(usage), by the name of the option that takes most, with the number that fits
void requireSampleMemory(const WriteOptions& write, int pieces, std::uint64_t limit,
                         const std::function<std::uint64_t(std::uint64_t enough)>& fracture,
                         std::uint64_t held = 0);

}  // namespace sherd
