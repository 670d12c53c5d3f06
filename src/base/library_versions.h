// Versions of the linked libraries.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sherd {

/// Returns names and versions of the linked libraries: at run time where the library reports it,
/// else of the build.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> libraryVersions();

}  // namespace sherd
