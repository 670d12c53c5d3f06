// Parsing and validation of option values.
#include "cli/arguments/option_text.h"

#include <charconv>
#include <cmath>
#include <limits>

#include "base/text/lower_case.h"
#include "base/text/option_text.h"

namespace sherd::cli {

std::optional<std::uint64_t> bytesIn(const std::string& text) {
  constexpr std::string_view kDigits = "0123456789", kUnits = "kmgtp";
  const std::size_t digits = std::min(text.find_first_not_of("0123456789."), text.size());
  const std::string number = text.substr(0, digits);
  std::string unit =
      lowerCase(text.substr(std::min(text.find_first_not_of(' ', digits), text.size())));
  int shift = 0;
  if (!unit.empty() && kUnits.find(unit.front()) != std::string_view::npos) {
    shift = 10 * (1 + static_cast<int>(kUnits.find(unit.front())));
    unit.erase(0, 1);
    if (unit == "ib") unit = "b";
  }
  if (!unit.empty() && unit != "b") return {};
  // The whole part and the fraction separately, because a double would round.
  const std::size_t point = std::min(number.find('.'), number.size());
  const std::string whole = number.substr(0, point);
  const std::string part = number.substr(std::min(point + 1, number.size()));
  if (whole.empty() || (point < number.size() && part.empty()) ||
      part.find_first_not_of(kDigits) != std::string::npos) {
    return {};
  }
  std::uint64_t count = 0, bytes = 0;
  const auto [stop, error] = std::from_chars(whole.data(), whole.data() + whole.size(), count);
  if (error != std::errc() || count > std::numeric_limits<std::uint64_t>::max() >> shift) return {};
  bytes = count << shift;
  const double rest = part.empty() ? 0.0 : numberIn("0." + part).value_or(0.0);
  bytes += static_cast<std::uint64_t>(rest * std::ldexp(1.0, shift));  // below 2^shift
  if (bytes == 0) return {};
  return bytes;
}

CLI::Validator size() {
  return CLI::Validator(
      [](std::string& text) -> std::string {
        const std::optional<std::uint64_t> bytes = bytesIn(text);
        if (!bytes) {
          return "'" + text + "' is not a size above 0 and below 2^64 bytes, such as 8G or 1.5 GiB";
        }
        text = std::to_string(*bytes);
        return {};
      },
      "");
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
