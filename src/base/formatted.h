// Text by a pattern.
#pragma once

#include <cstdio>
#include <string>

namespace sherd {

/// As printf has it, up to 511 characters.
template <class... Values>
std::string formatted(const char* pattern, Values... values) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

}  // namespace sherd
