// What options are made of, as text.
#include "cli/option_text.h"

#include <cmath>

#include "cli/fracture_options.h"

namespace sherd::cli {

std::optional<double> numberIn(std::string_view text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) return {};
  return value;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',') {
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

CLI::Validator oneOf(std::vector<int> numbers) {
  std::string all;
  for (const int number : numbers) all += (all.empty() ? "" : ", ") + std::to_string(number);
  return CLI::Validator(
      [numbers, all](std::string& text) -> std::string {
        const bool isOne = std::any_of(numbers.begin(), numbers.end(),
                                       [&](int number) { return text == std::to_string(number); });
        return isOne ? "" : "'" + text + "' is none of " + all;
      },
      "{" + all + "}");
}

CLI::Validator numberBetween(double low, double high, const std::string& range) {
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        const std::optional<double> value = numberIn(text);
        if (value && *value >= low && *value <= high) return {};
        return "'" + text + "' is not a number in " + range;
      },
      range);
}

CLI::Validator aboveZero() {
  return CLI::Validator(
      [](std::string& text) -> std::string {
        const std::optional<double> value = numberIn(text);
        return value && *value > 0 ? "" : "'" + text + "' is not a number above 0";
      },
      "> 0");
}

void refuse(const std::string& option, const std::string& text, const std::string& expected) {
  throw CLI::ValidationError(option, "'" + text + "' is not " + expected);
}

}  // namespace sherd::cli
