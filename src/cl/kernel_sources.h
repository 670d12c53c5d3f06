// The kernel files, embedded in the library by cmake/EmbedKernels.cmake.
#pragma once

#include <span>
#include <string_view>

namespace sherd {

/// The text of every embedded file behind a #line directive, headers first.
std::span<const std::string_view> kernelSources();

}  // namespace sherd
