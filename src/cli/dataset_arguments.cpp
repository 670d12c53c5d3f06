// The arguments of `sherd dataset`, before they are parsed.
#include "cli/dataset_arguments.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "cli/config_file.h"
#include "cli/drawn_options.h"

namespace sherd::cli {
namespace {

using Options = std::vector<std::pair<std::string, std::string>>;  // the second empty for flags

// Options that change nothing of what is written.
constexpr std::array<const char*, 14> kOfTheRun{
    "--output", "--device",  "--threads", "--max-memory",    "--json",
    "--quiet",  "--resume",  "--shard",   "--match",         "--limit",
    "--verify", "--dry-run", "--config",  "--object-timeout"};

// Groups of options that a fracture has of its own.
constexpr std::array<const char*, 4> kOfFractures{"Seeds", "Growth", "Erosion", "Surface"};

bool isFlag(const CLI::App& command, const std::string& name) {
  const CLI::Option* const option = command.get_option_no_throw(name);
  return option != nullptr && option->get_items_expected_max() == 0;
}

bool isOfFractures(const CLI::App& command, const std::string& name) {
  const CLI::Option* const option = command.get_option_no_throw(name);
  return option != nullptr && std::find(kOfFractures.begin(), kOfFractures.end(),
                                        option->get_group()) != kOfFractures.end();
}

// Options by name and value; all else goes to `rest`.
Options optionsOf(const std::vector<std::string>& arguments, const CLI::App& command,
                  std::vector<std::string>& rest) {
  Options options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (!argument.starts_with("--") || argument == "--") {
      rest.push_back(argument);
      if (argument == "-o" && i + 1 < arguments.size()) rest.push_back(arguments[++i]);
      continue;
    }
    const std::size_t equals = argument.find('=');
    if (equals != std::string::npos) {
      options.emplace_back(argument.substr(0, equals), argument.substr(equals + 1));
    } else if (isFlag(command, argument) || i + 1 == arguments.size()) {
      options.emplace_back(argument, "");
    } else {
      options.emplace_back(argument, arguments[++i]);
    }
  }
  return options;
}

std::string planOf(Options options) {
  std::stable_sort(options.begin(), options.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::string text;
  for (const auto& [name, value] : options) {
    if (std::find(kOfTheRun.begin(), kOfTheRun.end(), name) != kOfTheRun.end()) continue;
    text += text.empty() ? "" : " ";
    text += value.empty() ? name : name + "=" + value;
  }
  return text;
}

}  // namespace

std::vector<std::string> expandedArguments(const std::vector<std::string>& arguments,
                                           const CLI::App& command) {
  std::vector<std::string> expanded;
  Options options = optionsOf(arguments, command, expanded);
  std::set<std::string> given;
  for (const auto& [name, value] : options) given.insert(name);
  Options configured;
  for (const auto& [name, value] : options) {
    if (name != "--config") continue;
    for (const auto& [option, text] : optionsIn(value)) {
      if (!given.contains(option)) configured.emplace_back(option, text);
    }
  }
  options.insert(options.begin(), configured.begin(), configured.end());
  std::erase_if(options, [](const auto& option) { return option.first == "--config"; });
  for (const auto& [name, value] : options) {
    if (isOfFractures(command, name) && drawnOption(name, value)) {
      expanded.push_back("--drawn=" + name + "=" + value);
    } else {
      expanded.push_back(value.empty() ? name : name + "=" + value);
    }
  }
  const std::string plan = planOf(options);
  if (!plan.empty()) expanded.push_back("--plan=" + plan);
  return expanded;
}

}  // namespace sherd::cli
