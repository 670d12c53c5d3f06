// Numbers as text that does not depend on the locale.
#pragma once

#include <charconv>
#include <string>

namespace sherd {

/// Append a number in the fewest digits that read back as the same one.
template <class Number>
void appendShortest(std::string& text, Number value) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

inline void appendFloat(std::string& text, float value) { appendShortest(text, value + 0.0f); }

}  // namespace sherd
