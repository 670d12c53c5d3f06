// Reads options from a TOML or JSON file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sherd::cli {

/// One option of a file.
struct ConfiguredOption {
  std::string name;                 ///< without dashes
  std::string where;                ///< "options.toml:3: pieces", for messages
  std::optional<bool> flag;         ///< set for true and false; then `values` is empty
  std::vector<std::string> values;  ///< one value, or those of a list; none is an empty text
};

/// Reads the options of a TOML file (`pieces = "2..10"`) or, with the extension .json, of a JSON
/// object.  Names have no dashes.  A value is text, a number, true, false, or a list of texts and
/// numbers.  TOML's dates, inline tables, multi-line texts and dotted keys are refused, and table
/// headings are ignored.
///   throws  Error(input) with the line of TOML or the name in JSON: the file cannot be read or is
///           malformed, a name has no value or occurs twice
[[nodiscard]] std::vector<ConfiguredOption> optionsIn(const std::filesystem::path& file);

/// Parses a file's bytes; `file` gives the format by its extension, and the name in messages.
[[nodiscard]] std::vector<ConfiguredOption> parsedOptions(std::string bytes,
                                                          const std::filesystem::path& file);

}  // namespace sherd::cli
