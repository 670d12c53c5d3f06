// Texts of options' values.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// Returns the finite number that the whole text is, or nullopt.
[[nodiscard]] std::optional<double> numberIn(std::string_view text);

/// Returns the parts between commas; one empty part for an empty text.
[[nodiscard]] std::vector<std::string> split(const std::string& text, char separator = ',');

/// Returns the numbers of all parts, or nullopt if a part is not a number.
[[nodiscard]] std::optional<std::vector<double>> numbersIn(std::span<const std::string> parts);

/// Returns the texts, each after the first behind a separator.
[[nodiscard]] std::string joinedText(std::span<const std::string> parts, const char* separator);

/// Throws Error(usage) "'TEXT' is not EXPECTED".
[[noreturn]] void refuseValue(const std::string& text, const std::string& expected);

}  // namespace sherd
