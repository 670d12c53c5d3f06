// Options out of a file.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace sherd::cli {

/// Arguments out of a TOML file (`pieces = "2..10"`), or a JSON one by its extension: an object
/// with a value for each option's name, without dashes.  true is a flag, false none; lists are
/// joined by commas, but of `impact` each element is an option of its own.
///   return  ("--pieces", "2..10"), ...; the second is empty for flags
///   throws  Error(input) it cannot be read, or is nothing of the kind
[[nodiscard]] std::vector<std::pair<std::string, std::string>> optionsIn(
    const std::filesystem::path& file);

}  // namespace sherd::cli
