// Parsing of untrusted JSON.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

namespace sherd {

/// The size of a JSON text.
struct JsonExtent {
  int depth = 0;           ///< levels of lists and objects
  std::size_t values = 0;  ///< upper bound
};
[[nodiscard]] JsonExtent extentOf(std::string_view text);

/// Parses a text as JSON.
///   throws  Error(input) without a file's name: not JSON, nested deeper than 16 levels, a number
///           that no double can hold
[[nodiscard]] nlohmann::json parsedJson(std::string_view text);

/// The same, keeping the order of keys.
[[nodiscard]] nlohmann::ordered_json parsedOrderedJson(std::string_view text);

/// Reads a file as JSON.
///   kind    for messages: "seed file"
///   throws  Error(input) with the file's name: as above, absent, unreadable, larger than
///           `largestBytes`, or more memory needed than is free
[[nodiscard]] nlohmann::json readJson(const std::filesystem::path& file, const char* kind,
                                      std::uintmax_t largestBytes);

/// The same, keeping the order of keys.
[[nodiscard]] nlohmann::ordered_json readOrderedJson(const std::filesystem::path& file,
                                                     const char* kind, std::uintmax_t largestBytes);

}  // namespace sherd
