// Conversion to lower case.
#pragma once

#include <algorithm>
#include <string>

namespace sherd {

/// Converts ASCII letters to lower case, independent of the locale; other bytes are unchanged.
[[nodiscard]] inline std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

}  // namespace sherd
