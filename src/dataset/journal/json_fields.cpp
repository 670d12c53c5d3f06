// Checked fields of JSON objects from untrusted files.
#include "dataset/journal/json_fields.h"

#include <sherd/error.h>

namespace sherd::fields {

void damaged(const std::string& what) { throw Error(ErrorCode::input, what); }

const Json& get(const Json& object, const char* key, bool (Json::*is)() const noexcept,
                const char* kind) {
  const auto found = object.find(key);
  if (found == object.end()) damaged(std::string("has no \"") + key + "\"");
  if (!((*found).*is)()) damaged(std::string("\"") + key + "\" is not " + kind);
  return *found;
}

std::string text(const Json& object, const char* key) {
  return get(object, key, &Json::is_string, "text").get<std::string>();
}

const Json& list(const Json& object, const char* key) {
  return get(object, key, &Json::is_array, "a list");
}

void requireNumber(const Json& object, const char* key) {
  (void)get(object, key, &Json::is_number, "a number");
}

std::uint64_t count(const Json& object, const char* key, std::uint64_t low, std::uint64_t high) {
  const auto value =
      get(object, key, &Json::is_number_unsigned, "a whole number").get<std::uint64_t>();
  if (value < low || value > high) {
    damaged(std::string("\"") + key + "\" is out of range: " + std::to_string(value));
  }
  return value;
}

}  // namespace sherd::fields
