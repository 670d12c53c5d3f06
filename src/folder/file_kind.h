// Detection of a file's kind.
#pragma once

#include <sherd/files.h>

#include <filesystem>

namespace sherd {

enum class FileKind { voxels, mesh, points, other };

/// Returns the kind of a file by its extension.  A `.ply` with faces is a mesh, else points; the
/// kind of an `.npz` is determined by the names of its arrays.
///   throws  Error(input) a `.ply` or `.npz` cannot be read, or is larger than `options` allow
[[nodiscard]] FileKind kindOf(const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace sherd
