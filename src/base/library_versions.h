// What this build is made of.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sherd {

/// Names and versions of the libraries that are linked: those at run time where a library reports
/// its own, else those of the build.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> libraryVersions();

}  // namespace sherd
