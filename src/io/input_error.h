// What is wrong with a file that is read.
#pragma once

#include <sherd/error.h>

#include <filesystem>
#include <string>

namespace sherd {

/// throws  Error(input) "FILE: what"
[[noreturn]] inline void inputError(const std::filesystem::path& file, const std::string& what) {
  throw Error(ErrorCode::input, file.string() + ": " + what);
}

}  // namespace sherd
