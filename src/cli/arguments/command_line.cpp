// Checks of the command line before it is parsed.
#include "cli/arguments/command_line.h"

#include <sherd/error.h>

#include <algorithm>

#include "cli/arguments/nearest_name.h"

namespace sherd::cli {

void checkArguments(const CLI::App& app, const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    if (argument.size() < 4 || !argument.starts_with("--")) continue;
    if (argument.find('=') != argument.size() - 1) continue;
    throw Error(ErrorCode::usage, argument + " has no value (try sherd --help)");
  }
  if (arguments.empty() || arguments.front().starts_with('-')) return;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  if (std::find(names.begin(), names.end(), arguments.front()) != names.end()) return;
  const std::vector<std::string> nearest = nearestNames(arguments.front(), names);
  throw Error(ErrorCode::usage, "'" + arguments.front() + "' is not a command" +
                                    (nearest.empty() ? ", the commands are " + quotedList(names)
                                                     : ", the nearest is " + quotedList(nearest)) +
                                    " (try sherd --help)");
}

}  // namespace sherd::cli
