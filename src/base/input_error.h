// What is wrong with a file that is read.
#pragma once

#include <sherd/error.h>

#include <filesystem>
#include <string>
#include <system_error>

namespace sherd {

/// throws  Error(input) "FILE: what"
[[noreturn]] inline void inputError(const std::filesystem::path& file, const std::string& what) {
  throw Error(ErrorCode::input, file.string() + ": " + what);
}

/// What is at a path, file_type::not_found where nothing is.
///   throws  Error(input) nobody can tell: the name is too long, a link leads to itself, a folder
///           may not be entered
[[nodiscard]] inline std::filesystem::file_type whatIsAt(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_type type = std::filesystem::status(path, error).type();
  if (type == std::filesystem::file_type::none) {
    inputError(path, "cannot be read: " + error.message());
  }
  return type;
}

}  // namespace sherd
