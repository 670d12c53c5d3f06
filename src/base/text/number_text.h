// Numbers as text, independent of the locale.
#pragma once

#include <charconv>
#include <glm/vec3.hpp>
#include <string>

namespace sherd {

/// Appends a number with the fewest digits that read back exactly.
template <class Number>
void appendShortest(std::string& text, Number value) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
}

inline void appendFloat(std::string& text, float value) { appendShortest(text, value + 0.0f); }

/// Appends " x y z" in single or double precision.
inline void appendVector(std::string& text, const glm::dvec3& v, bool isDouble = false) {
  for (int axis = 0; axis < 3; ++axis) {
    text += ' ';
    if (isDouble) {
      appendShortest(text, v[axis] + 0.0);
    } else {
      appendFloat(text, static_cast<float>(v[axis]));
    }
  }
}

}  // namespace sherd
