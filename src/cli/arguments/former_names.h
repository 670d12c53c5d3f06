// Names of options and values in an earlier version.
#pragma once

#include <string>
#include <vector>

#include "cli/arguments/config_file.h"

namespace sherd::cli {

/// Replaces former names of options and values by the current ones, each with a warning on standard
/// error.  Former names are accepted for one version.
[[nodiscard]] std::vector<std::string> withCurrentNames(std::vector<std::string> arguments);

/// Same, for an option of a configuration file.
[[nodiscard]] ConfiguredOption withCurrentNames(ConfiguredOption option);

}  // namespace sherd::cli
