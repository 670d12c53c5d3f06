// Texts of options' values.
#include "base/text/option_text.h"

#include <sherd/error.h>

#include <charconv>
#include <cmath>

namespace sherd {

std::optional<double> numberIn(std::string_view text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) return {};
  return value;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::optional<std::vector<double>> numbersIn(std::span<const std::string> parts) {
  std::vector<double> numbers;
  for (const std::string& part : parts) {
    const std::optional<double> value = numberIn(part);
    if (!value) return {};
    numbers.push_back(*value);
  }
  return numbers;
}

std::string joinedText(std::span<const std::string> parts, const char* separator) {
  std::string all;
  for (const std::string& part : parts) all += (&part == parts.data() ? "" : separator) + part;
  return all;
}

void refuseValue(const std::string& text, const std::string& expected) {
  throw Error(ErrorCode::usage, "'" + text + "' is not " + expected);
}

}  // namespace sherd
