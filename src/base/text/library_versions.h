// Versions of Sherd and of the linked libraries.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sherd {

/// Also declared in sherd/sherd.h.
[[nodiscard]] const char* version();

/// Returns names and versions of the linked libraries: at run time where the library reports it,
/// else of the build.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> libraryVersions();

}  // namespace sherd
