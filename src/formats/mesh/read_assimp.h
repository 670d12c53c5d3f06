// Reads FBX, DAE and 3MF files by Assimp, in a program of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// What the program may use before it is stopped.
struct AssimpLimits {
  std::uint64_t memoryMiB = 0;  ///< of addresses, and of what it answers
  unsigned cpuSeconds = 0;
  unsigned wallSeconds = 0;
};

/// Plenty for any file of that size.
///   memory  bytes that may be used, which is never passed
[[nodiscard]] AssimpLimits assimpLimits(
    std::size_t bytes, std::uint64_t memory = std::numeric_limits<std::uint64_t>::max());

/// Where `sherd-assimp` (src/assimp_program/) is: what the environment variable SHERD_ASSIMP names,
/// else beside the running program or where it is installed.
struct AssimpProgram {
  std::optional<std::filesystem::path> found;
  std::vector<std::filesystem::path> tried;
};
[[nodiscard]] AssimpProgram findAssimp();

/// Every triangle that the file's nodes show, in single precision, with its look, by
/// `sherd-assimp`.  Whatever a malformed file does to Assimp ends that program and not this one.
///   throws  Error(input) what Assimp refuses or dies of, or what takes more than the limits;
///   Error(cancelled) stopped by SIGINT, SIGTERM or SIGHUP, or as the file's progress says
[[nodiscard]] RawMesh readByAssimp(const MeshFile& file, const AssimpLimits& limits);

}  // namespace sherd
