// Options out of a file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sherd::cli {

/// An option as a file has it.
struct ConfiguredOption {
  std::string name;                 ///< without dashes
  std::string where;                ///< "options.toml:3: pieces", for messages
  std::optional<bool> flag;         ///< true or false, and then there are no values
  std::vector<std::string> values;  ///< one, or those of a list; none is empty
};

/// The options in a TOML file (`pieces = "2..10"`), or a JSON one by its extension: an object with
/// a value for each option's name, without dashes.  A value is text, a number, true, false, or a
/// list of texts and numbers.  Of TOML only that is read: no dates, tables in a line, text over
/// several lines, or dotted keys; headings of tables are passed over.
///   throws  Error(input) with the line, of JSON with the name: it cannot be read, is nothing of
///           the kind, has no value for a name or a name twice
[[nodiscard]] std::vector<ConfiguredOption> optionsIn(const std::filesystem::path& file);

/// The same of a file's bytes; `file` says by its extension what they are, and names them.
[[nodiscard]] std::vector<ConfiguredOption> parsedOptions(std::string bytes,
                                                          const std::filesystem::path& file);

}  // namespace sherd::cli
