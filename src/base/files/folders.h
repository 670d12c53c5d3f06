// Kinds of files, and folders that are made.
#pragma once

#include <sherd/error.h>
#include <sys/stat.h>

#include <cerrno>
#include <filesystem>
#include <string>

#include "base/files/atomic_file.h"

namespace sherd {

[[noreturn]] inline void outputError(const std::filesystem::path& path, const std::string& what) {
  throw Error(ErrorCode::output, path.string() + ": " + what);
}

/// Returns what a path is, without following a link.
[[nodiscard]] inline std::filesystem::file_type typeOf(const std::filesystem::path& path) {
  std::error_code none;
  return std::filesystem::symlink_status(path, none).type();
}

/// Whether a path is a folder, and no link to one.
[[nodiscard]] inline bool isFolder(const std::filesystem::path& path) {
  return typeOf(path) == std::filesystem::file_type::directory;
}

/// Makes a folder, unless it is there.
///   throws  Error(output)
inline void makeFolder(const std::filesystem::path& folder) {
  if (::mkdir(folder.c_str(), 0777) != 0 && errno != EEXIST)
    outputError(folder, "cannot be made: " + reasonOf(errno));
}

}  // namespace sherd
