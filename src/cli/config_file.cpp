// Options out of a file.
#include "cli/config_file.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/input_error.h"
#include "lower_case.h"
#include "mesh/file_bytes.h"

namespace sherd::cli {
namespace {

using Options = std::vector<std::pair<std::string, std::string>>;

std::string joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : ",") + part;
  return all;
}

void add(Options& options, const std::string& name, const std::vector<std::string>& values) {
  const std::string option = "--" + name;
  if (name == "impact") {
    for (const std::string& value : values) options.emplace_back(option, value);
  } else if (values.size() == 1 && values[0] == "true") {
    options.emplace_back(option, "");
  } else if (values.size() != 1 || values[0] != "false") {
    options.emplace_back(option, joined(values));
  }
}

Options inToml(const std::filesystem::path& file) {
  Options options;
  std::istringstream text(readFileBytes(file));
  try {
    for (const CLI::ConfigItem& item : CLI::ConfigTOML().from_config(text)) {
      if (item.name == "++" || item.name == "--") continue;  // the begin and end of a section
      add(options, item.name, item.inputs);
    }
  } catch (const CLI::Error& e) {
    inputError(file, std::string("is no TOML of options: ") + e.what());
  }
  return options;
}

std::string textOf(const nlohmann::json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

Options inJson(const std::filesystem::path& file) {
  const auto json = nlohmann::ordered_json::parse(readFileBytes(file), nullptr, false);
  if (!json.is_object()) inputError(file, "is no JSON object of options");
  Options options;
  for (const auto& [name, value] : json.items()) {
    std::vector<std::string> values;
    if (value.is_array()) {
      for (const auto& one : value) values.push_back(textOf(one));
    } else if (value.is_object() || value.is_null()) {
      inputError(file, "has no value for " + name + ": text, a number, true, false or a list");
    } else {
      values.push_back(textOf(value));
    }
    add(options, name, values);
  }
  return options;
}

}  // namespace

Options optionsIn(const std::filesystem::path& file) {
  return lowerCase(file.extension().string()) == ".json" ? inJson(file) : inToml(file);
}

}  // namespace sherd::cli
