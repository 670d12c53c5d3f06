// Formatted text.
#pragma once

#include <cstdio>
#include <string>

namespace sherd {

/// Formats as printf does, truncated to 511 characters.
template <class... Values>
std::string formatted(const char* pattern, Values... values) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

}  // namespace sherd
