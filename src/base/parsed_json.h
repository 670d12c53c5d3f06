// JSON that anybody may have written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

namespace sherd {

/// How much a text is as JSON.
struct JsonExtent {
  int depth = 0;           ///< levels of lists and objects
  std::size_t values = 0;  ///< at most
};
[[nodiscard]] JsonExtent extentOf(std::string_view text);

/// Text as JSON.
///   throws  Error(input) without a file's name: not JSON, nested deeper than 16 levels, a number
///           that no double can hold
[[nodiscard]] nlohmann::json parsedJson(std::string_view text);

/// The same, with the keys of objects in their order.
[[nodiscard]] nlohmann::ordered_json parsedOrderedJson(std::string_view text);

/// A file as JSON, which a `kind` of file is: "seed file".
///   throws  Error(input) with the file's name, as above; absent, unreadable, larger than
///           `largestBytes`, or it would take more memory than is free
[[nodiscard]] nlohmann::json readJson(const std::filesystem::path& file, const char* kind,
                                      std::uintmax_t largestBytes);

/// The same, with the keys of objects in their order.
[[nodiscard]] nlohmann::ordered_json readOrderedJson(const std::filesystem::path& file,
                                                     const char* kind, std::uintmax_t largestBytes);

}  // namespace sherd
