// The kernel files, embedded in the library by cmake/EmbedKernels.cmake.
#pragma once

#include <span>
#include <string_view>

namespace sherd::kernels {

struct Source {
  std::string_view file;  ///< name without folder
  std::string_view text;  ///< behind a #line directive
};

/// Every embedded file, headers first.
std::span<const Source> sources();

}  // namespace sherd::kernels
