// Checks of the command line before it is parsed.
#pragma once

#include <string>
#include <vector>

#include "cli/terminal/command.h"

namespace sherd::cli {

/// Refuses an unknown command, which CLI11 reports without its name, and "--option=" without a
/// value, for which CLI11 consumes the next argument.
///   throws  Error(usage)
void checkArguments(const CLI::App& app, const std::vector<std::string>& arguments);

}  // namespace sherd::cli
