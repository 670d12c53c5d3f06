// Safe file names from untrusted text.
#pragma once

#include <string>

namespace sherd {

/// Converts untrusted text to a name for files and JSON: valid UTF-8, no control characters, no
/// slash, no leading dot, at most 200 bytes; `otherwise` if the result would be empty.
[[nodiscard]] std::string safeName(std::string name, const std::string& otherwise);

/// Replaces each space by '_', for formats in which a space ends a name.
[[nodiscard]] std::string withoutBlanks(std::string name);

}  // namespace sherd
