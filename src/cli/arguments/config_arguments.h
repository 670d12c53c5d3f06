// Adds the options of configuration files to the arguments before they are parsed.
#pragma once

#include <string>
#include <vector>

#include "cli/terminal/command.h"

namespace sherd::cli {

/// Adds --config FILE, which expandedArguments replaces.
CLI::Option* addConfig(CLI::App& command);

/// Replaces --config FILE by the file's options, except those that the command line sets too.
///   arguments  after the sub-command's name
///   throws     Error(input) a file cannot be read, or has an option that it may not set
[[nodiscard]] std::vector<std::string> expandedArguments(const std::vector<std::string>& arguments,
                                                         const CLI::App& command);

}  // namespace sherd::cli
