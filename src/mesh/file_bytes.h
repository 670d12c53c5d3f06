// A file's bytes.
#pragma once

#include <filesystem>
#include <string>

namespace sherd {

/// Read a whole file into memory.
///   throws  Error(input) absent, a directory, not a regular file, unreadable
[[nodiscard]] std::string readFileBytes(const std::filesystem::path& file);

}  // namespace sherd
