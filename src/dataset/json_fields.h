// Fields of JSON objects that anybody may have written.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "dataset/journal.h"

namespace sherd {

///   throws  Error(input), as do all of these: a sentence without the file's name
[[noreturn]] void damaged(const std::string& what);

/// A field of the kind that `is` knows: &Json::is_string and the like.
[[nodiscard]] const Json& field(const Json& object, const char* key,
                                bool (Json::*is)() const noexcept, const char* kind);

[[nodiscard]] std::string text(const Json& object, const char* key);
[[nodiscard]] const Json& list(const Json& object, const char* key);
void requireNumber(const Json& object, const char* key);

/// A whole number in low..high.
[[nodiscard]] std::uint64_t count(const Json& object, const char* key, std::uint64_t low = 0,
                                  std::uint64_t high = std::numeric_limits<std::uint64_t>::max());

}  // namespace sherd
