// Command-line options from tables of options.
#pragma once

#include <sherd/dataset.h>
#include <sherd/error.h>
#include <sherd/options.h>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text/option_text.h"
#include "cli/terminal/command.h"

namespace sherd::cli {

/// Returns how the help shows the values: "FLOAT:0..1", ":{a,b}".
template <class Target>
[[nodiscard]] std::string typeText(const OptionValue<Target>& value) {
  if (!value.choices.empty()) {
    const bool isNumber = value.type == OptionType::length || value.type == OptionType::number;
    const char* const comma =
        value.type == OptionType::whole || value.type == OptionType::length ? ", " : ",";
    return ":{" + joinedText(value.choices, comma) + "}" + (isNumber ? "|" + value.range : "");
  }
  if (value.type == OptionType::whole) return "INT:" + value.range;
  if (value.type == OptionType::number || value.type == OptionType::length) {
    return "FLOAT:" + value.range;
  }
  return value.range;
}

/// Returns an option's default as text; empty where it has none.
template <class Target>
[[nodiscard]] std::string defaultText(const OptionValue<Target>& value, const Target& options) {
  const std::string text = value.text(options);
  try {
    Target tried = options;
    value.set(tried, text);
  } catch (const Error&) {
    return {};  // a value that cannot be given, such as a size of 0
  }
  return text;
}

/// Adds an option; `set` throws Error(usage) for a text that the option does not accept.
///   names  "--a", or "--a,--b"
template <class Target>
CLI::Option* addRow(CLI::App& command, const std::string& names, const OptionRow<Target>& row,
                    const Target& options, std::function<void(const std::string&)> set) {
  const auto checked = [flag = names.substr(0, names.find(',')), set](const std::string& text) {
    try {
      set(text);
    } catch (const Error& e) {
      throw CLI::ValidationError(flag, e.what());
    }
  };
  const OptionValue<Target>& value = row.value;
  if (value.type == OptionType::flag) {
    return command
        .add_flag_callback(
            names, [checked] { checked("true"); }, row.help)
        ->group(*row.group != '\0' ? row.group : "Options");
  }
  CLI::Option* option = nullptr;
  const bool isList = value.type == OptionType::choices || value.type == OptionType::wholes;
  if (row.repeats || isList) {
    option = command.add_option_function<std::vector<std::string>>(
        names,
        [checked, isList](const std::vector<std::string>& all) {
          if (isList) return checked(joinedText(all, ","));  // given twice: both lists
          for (const std::string& text : all) checked(text);
        },
        row.help);
    option->allow_extra_args(false);
  } else {
    option = command.add_option_function<std::string>(names, checked, row.help);
  }
  option->type_name(typeText(value));
  const std::string usual = defaultText(value, options);
  if (!usual.empty()) option->default_str(usual);
  return option->group(*row.group != '\0' ? row.group : "Options");
}

/// Adds which options exclude and need which, once all are there.
template <class Target>
void addRelations(CLI::App& command, std::span<const OptionRow<Target>> rows) {
  const auto named = [&](const char* name) {
    return *name == '\0' ? nullptr : command.get_option_no_throw("--" + std::string(name));
  };
  for (const OptionRow<Target>& row : rows) {
    CLI::Option* const option = row.hidden ? nullptr : named(row.name);
    if (option == nullptr) continue;
    if (CLI::Option* const other = named(row.excludes)) option->excludes(other);
    if (CLI::Option* const other = named(row.needs)) option->needs(other);
  }
}

/// Adds all options of a fracture.
void addFractureOptions(CLI::App& command, RunOptions& options);

/// Adds the options of a dataset and of its fractures.  A range or a choice in place of a value is
/// added to options.drawn.
void addDatasetOptions(CLI::App& command, DatasetOptions& options);

/// Sets the options of a parsed command line on top of others.
void setGivenOptions(const CLI::App& command, RunOptions& options);

/// Describes a parsed command line for idleOptions.
[[nodiscard]] OptionUse useOf(const CLI::App& command);

}  // namespace sherd::cli
