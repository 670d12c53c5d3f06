// Names of options and values in an earlier version.
#include "cli/arguments/former_names.h"

#include <string_view>

#include "cli/terminal/command.h"

namespace sherd::cli {
namespace {

struct FormerOption {
  std::string_view former, current;
};
constexpr FormerOption kOptions[] = {{"--erode-crumbs", "--erode-islands"},
                                     {"--meters-per-unit", "--unit"}};

struct FormerValue {
  std::string_view option, former, current;
};
constexpr FormerValue kValues[] = {{"--erode-islands", "wear", "erode"},
                                   {"--write", "rims", "boundaries"},
                                   {"--pad", "cube-centred", "cube-centered"}};

void warn(std::string_view former, std::string_view current) {
  printMessage("sherd: warning: " + std::string(former) + " is now " + std::string(current) +
               "; the former name is accepted until the next version");
}

std::string currentOption(const std::string& name) {
  for (const FormerOption& option : kOptions) {
    if (name != option.former) continue;
    warn(option.former, option.current);
    return std::string(option.current);
  }
  return name;
}

// Converts a value, or several separated by commas.
std::string currentValues(std::string_view option, const std::string& values) {
  std::string all;
  for (std::size_t begin = 0; begin <= values.size();) {
    const std::size_t end = std::min(values.find(',', begin), values.size());
    std::string one = values.substr(begin, end - begin);
    for (const FormerValue& value : kValues) {
      if (option != value.option || one != value.former) continue;
      const std::string prefix = std::string(option) + " ";
      warn(prefix + one, prefix + std::string(value.current));
      one = value.current;
    }
    all += (begin > 0 ? "," : "") + one;
    begin = end + 1;
  }
  return all;
}

}  // namespace

std::vector<std::string> withCurrentNames(std::vector<std::string> arguments) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--") break;
    if (!arguments[i].starts_with("--")) continue;
    const std::size_t equals = arguments[i].find('=');
    const std::string name = currentOption(arguments[i].substr(0, equals));
    if (equals != std::string::npos) {
      arguments[i] = name + "=" + currentValues(name, arguments[i].substr(equals + 1));
      continue;
    }
    arguments[i] = name;
    if (i + 1 < arguments.size()) arguments[i + 1] = currentValues(name, arguments[i + 1]);
  }
  return arguments;
}

ConfiguredOption withCurrentNames(ConfiguredOption option) {
  const std::string name = currentOption("--" + option.name);
  option.name = name.substr(2);
  for (std::string& value : option.values) value = currentValues(name, value);
  return option;
}

}  // namespace sherd::cli
