// Errors of files that are read.
#pragma once

#include <sherd/error.h>

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

namespace sherd {

/// For text whose file the caller adds.
///   throws  Error(input) what
[[noreturn]] inline void inputError(const std::string& what) {
  throw Error(ErrorCode::input, what);
}

///   throws  Error(input) "FILE: what"
[[noreturn]] inline void inputError(const std::filesystem::path& file, const std::string& what,
                                    OptionNames options = {}) {
  throw Error(ErrorCode::input, file.string() + ": " + what, std::move(options));
}

/// Returns the type of a path's entry, file_type::not_found if there is none.
///   throws  Error(input) the type cannot be determined: the name is too long, a link is a loop, no
///           permission for a folder
[[nodiscard]] inline std::filesystem::file_type whatIsAt(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_type type = std::filesystem::status(path, error).type();
  if (type == std::filesystem::file_type::none) {
    inputError(path, "cannot be read: " + error.message());
  }
  return type;
}

}  // namespace sherd
