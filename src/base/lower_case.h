// Text without capitals.
#pragma once

#include <algorithm>
#include <string>

namespace sherd {

/// ASCII's capitals as small letters, whatever the locale; all other bytes as they are.
[[nodiscard]] inline std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

}  // namespace sherd
