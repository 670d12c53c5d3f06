// Reads FBX and DAE files by Assimp, in a separate process.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Limits of the process, which is stopped beyond them.
struct AssimpLimits {
  std::uint64_t memoryMiB = 0;  ///< of address space, and of output
  unsigned cpuSeconds = 0;
  unsigned wallSeconds = 0;
};

/// Returns limits that suffice for any file of that size.
///   memory  limit in bytes, never exceeded
[[nodiscard]] AssimpLimits assimpLimits(
    std::size_t bytes, std::uint64_t memory = std::numeric_limits<std::uint64_t>::max());

/// Reads every triangle of the file's nodes, in single precision, with its attributes, by
/// `sherd-assimp`. If a malformed file crashes Assimp, only that process ends.
///   throws  Error(input) a file that Assimp refuses, that crashes it or exceeds the limits;
///           Error(cancelled) stopped by SIGINT, SIGTERM or SIGHUP, or by the file's progress
[[nodiscard]] RawMesh readByAssimp(const MeshFile& file, const AssimpLimits& limits);

}  // namespace sherd
