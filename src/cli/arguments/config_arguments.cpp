// Adds the options of configuration files to the arguments before they are parsed.
#include "cli/arguments/config_arguments.h"

#include <sherd/error.h>
#include <sherd/options.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <utility>

#include "cli/arguments/config_file.h"
#include "cli/arguments/nearest_name.h"

namespace sherd::cli {
namespace {

/// An option of the command line, or of a file.
struct Given {
  std::string name;  // "--pieces"
  std::optional<std::string> value{};
};
using GivenOptions = std::vector<Given>;

// Options that a file may not set: --config would recurse, --help ends the run.
constexpr std::array<const char*, 2> kNotInFiles{"--config", "--help"};

bool isFlag(const CLI::App& command, const std::string& name) {
  const CLI::Option* const option = command.get_option_no_throw(name);
  return option != nullptr && option->get_items_expected_max() == 0;
}

// Returns options by name and value; other arguments go to `rest`.
GivenOptions optionsOf(const std::vector<std::string>& arguments, const CLI::App& command,
                       std::vector<std::string>& rest) {
  GivenOptions options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (argument.starts_with("-o") && argument.size() > 2) {
      options.push_back({"--output", argument.substr(2)});
      continue;
    }
    if (argument == "-o" && i + 1 < arguments.size()) {
      options.push_back({"--output", arguments[++i]});
      continue;
    }
    if (!argument.starts_with("--") || argument == "--") {
      rest.push_back(argument);
      continue;
    }
    const std::size_t equals = argument.find('=');
    if (equals != std::string::npos) {
      options.push_back({argument.substr(0, equals), argument.substr(equals + 1)});
    } else if (isFlag(command, argument) || i + 1 == arguments.size()) {
      options.push_back({argument});
    } else {
      options.push_back({argument, arguments[++i]});
    }
  }
  return options;
}

// Returns the names of all options that a file may set.
std::vector<std::string> namesIn(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      const auto* const found = std::find(kNotInFiles.begin(), kNotInFiles.end(), "--" + name);
      if (found == kNotInFiles.end()) names.push_back(name);
    }
  }
  return names;
}

// Converts an option of a file to command-line options.
GivenOptions given(const ConfiguredOption& configured, const CLI::App& command) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::input, configured.where + " " + what);
  };
  const std::vector<std::string> names = namesIn(command);
  if (std::find(names.begin(), names.end(), configured.name) == names.end()) {
    const std::vector<std::string> nearest = nearestNames(configured.name, names);
    refuse("is not an option that a file may set" +
           (nearest.empty() ? "; sherd " + command.get_name() + " --help lists them"
                            : ", the nearest is " + quotedList(nearest)));
  }
  const std::string name = "--" + configured.name;
  if (isFlag(command, name) != configured.flag.has_value()) {
    refuse(configured.flag ? "takes a value, not true or false" : "is true or false, not a value");
  }
  if (configured.flag) return *configured.flag ? GivenOptions{{name}} : GivenOptions{};
  GivenOptions options;
  const FractureOptionRow* const row = fractureOption(configured.name);
  if (row != nullptr && row->repeats) {
    for (const std::string& value : configured.values) options.push_back({name, value});
    return options;
  }
  std::string all;
  for (const std::string& value : configured.values) all += (all.empty() ? "" : ",") + value;
  return {{name, all}};
}

}  // namespace

CLI::Option* addConfig(CLI::App& command) {
  return command
      .add_option("--config",
                  "Read options from a TOML or JSON file; the command line overrides them")
      ->type_name("FILE");
}

std::vector<std::string> expandedArguments(const std::vector<std::string>& arguments,
                                           const CLI::App& command) {
  std::vector<std::string> expanded;
  GivenOptions options = optionsOf(arguments, command, expanded);
  std::set<std::string> named;
  for (const Given& option : options) named.insert(option.name);
  GivenOptions ofFiles;
  for (const Given& option : options) {
    if (option.name != "--config" || !option.value) continue;
    for (const ConfiguredOption& configured : optionsIn(*option.value)) {
      for (Given& own : given(configured, command)) {
        if (!named.contains(own.name)) ofFiles.push_back(std::move(own));
      }
    }
  }
  options.insert(options.begin(), ofFiles.begin(), ofFiles.end());
  std::erase_if(options, [](const Given& option) { return option.name == "--config"; });
  for (const auto& [name, value] : options) {
    if (!value) {
      expanded.push_back(name);
    } else if (value->empty()) {  // the parser reads "--name=" as an option without a value
      expanded.insert(expanded.end(), {name, ""});
    } else {
      expanded.push_back(name + "=" + *value);
    }
  }
  return expanded;
}

}  // namespace sherd::cli
