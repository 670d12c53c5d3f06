// What kind of thing a file holds.
#pragma once

#include <sherd/read_options.h>

#include <filesystem>

namespace sherd {

enum class FileKind { voxels, mesh, points, other };

/// By the extension; in a `.ply` faces make a mesh, and an `.npz` is told by the names of its
/// arrays.
///   throws  Error(input) a `.ply` or `.npz` that cannot be read, or is larger than `options` allow
[[nodiscard]] FileKind kindOf(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace sherd
