// Names of files that come from elsewhere.
#pragma once

#include <string>

namespace sherd {

/// A text from a file as the name of a file or a thing, which JSON can hold: nothing but UTF-8, no
/// control characters, no slash, no dot to begin with, at most 200 bytes; `otherwise` where nothing
/// is left.
[[nodiscard]] std::string safeName(std::string name, const std::string& otherwise);

/// A name with '_' for each blank, for formats in which a blank ends it.
[[nodiscard]] std::string withoutBlanks(std::string name);

}  // namespace sherd
