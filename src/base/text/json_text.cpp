// Text of JSON that holds no number that JSON cannot hold.
#include "base/text/json_text.h"

#include <sherd/error.h>

#include <cmath>

namespace sherd {
namespace {

using Json = nlohmann::ordered_json;

// Throws if a number of `json`, which is at `path`, is not finite.
void requireFinite(const Json& json, const std::string& path) {
  if (json.is_number_float()) {
    if (std::isfinite(json.get<double>())) return;
    throw Error(ErrorCode::internal, path + " is not a finite number; please report it");
  }
  if (json.is_array()) {
    for (std::size_t i = 0; i < json.size(); ++i) {
      if (json[i].is_structured() || json[i].is_number_float())
        requireFinite(json[i], path + "[" + std::to_string(i) + "]");
    }
  } else if (json.is_object()) {
    for (const auto& [name, value] : json.items()) {
      if (value.is_structured() || value.is_number_float())
        requireFinite(value, path.empty() ? name : path + "." + name);
    }
  }
}

}  // namespace

std::string jsonText(const Json& json, int indent) {
  requireFinite(json, "");
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace sherd
