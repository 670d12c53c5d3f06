// Text of JSON that holds no number that JSON cannot hold.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace sherd {

/// Returns JSON as text.  Bytes of strings that are not UTF-8 are replaced.
///   indent  spaces, or -1 for one line
///   throws  Error(internal) a number that is not finite, which JSON would hold as null; the
///           message names it
[[nodiscard]] std::string jsonText(const nlohmann::ordered_json& json, int indent);

}  // namespace sherd
