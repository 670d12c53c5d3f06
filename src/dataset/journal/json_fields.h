// Checked fields of JSON objects from untrusted files.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "dataset/journal/journal.h"

namespace sherd::fields {

/// Reports a damaged file.  All functions here throw the same.
///   throws  Error(input) `what`, without the file's name
[[noreturn]] void damaged(const std::string& what);

/// Returns a field that `is` accepts, such as &Json::is_string.
///   kind  the expected kind, for the message
[[nodiscard]] const Json& get(const Json& object, const char* key,
                              bool (Json::*is)() const noexcept, const char* kind);

[[nodiscard]] std::string text(const Json& object, const char* key);
[[nodiscard]] const Json& list(const Json& object, const char* key);
void requireNumber(const Json& object, const char* key);

/// Returns a whole number in low..high.
[[nodiscard]] std::uint64_t count(const Json& object, const char* key, std::uint64_t low = 0,
                                  std::uint64_t high = std::numeric_limits<std::uint64_t>::max());

}  // namespace sherd::fields
