// The command line before it is parsed.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"

namespace sherd::cli {

/// Refuse what CLI11 has no sentence for: a command that there is not, of which it does not give
/// the name, and "--option=" without a value, for which it takes the next argument.
///   throws  Error(usage)
void checkArguments(const CLI::App& app, const std::vector<std::string>& arguments);

}  // namespace sherd::cli
