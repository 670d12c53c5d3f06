// The arguments of `sherd dataset`, before they are parsed.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"

namespace sherd::cli {

/// Expand what the parser does not know: --config FILE, of which what the command line has too is
/// left out; options that are drawn for each fracture (see drawn_options.h), which become
/// --drawn NAME=VALUE; and add --plan TEXT, which tells all options that shape the dataset.
///   arguments  after the sub-command's name
///   throws     Error(input) the file
[[nodiscard]] std::vector<std::string> expandedArguments(const std::vector<std::string>& arguments,
                                                         const CLI::App& command);

}  // namespace sherd::cli
