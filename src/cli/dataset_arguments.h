// Expands the arguments of `sherd dataset` before they are parsed.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"

namespace sherd::cli {

/// Replaces --config FILE by the file's options, except those that the command line sets too;
/// replaces options that are drawn for each fracture (see drawn_options.h) by --drawn=NAME=VALUE;
/// adds --plan=TEXT, which lists all options that shape the dataset.
///   arguments  after the sub-command's name
///   throws     Error(input) a file cannot be read, or has an option that it may not set
[[nodiscard]] std::vector<std::string> expandedArguments(const std::vector<std::string>& arguments,
                                                         const CLI::App& command);

}  // namespace sherd::cli
