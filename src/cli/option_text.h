// What options are made of, as text.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sherd::cli {

/// The finite number that a text is, if it is one.
[[nodiscard]] std::optional<double> numberIn(std::string_view text);

/// The parts of a text between its commas; of "" one empty part.
[[nodiscard]] std::vector<std::string> split(const std::string& text);

/// The numbers of "1", "2", "3"; nothing where one is none.
[[nodiscard]] std::optional<std::vector<double>> numbersIn(std::span<const std::string> parts);

/// Accepts numbers from `low` to `high`.
[[nodiscard]] CLI::Validator numberBetween(double low, double high, const std::string& range);

/// The bytes that a size is: a whole or decimal number above 0, and behind it, after blanks or
/// none, K, M, G, T or P of 1024 each, also as KB or KiB, in any case; or B.  Nothing for any other
/// text, and for 2^64 bytes or more.
[[nodiscard]] std::optional<std::uint64_t> bytesIn(const std::string& text);

/// Accepts sizes, and makes bytes of them.
[[nodiscard]] CLI::Validator size();

/// Accepts some whole numbers only.
[[nodiscard]] CLI::Validator oneOf(std::vector<int> numbers);

/// throws  CLI::ValidationError "option: 'text' is not expected"
[[noreturn]] void refuse(const std::string& option, const std::string& text,
                         const std::string& expected);

/// An option whose value is one of `names`, in the order of the enum.
template <class Enum>
CLI::Option* addChoice(CLI::App& command, const std::string& name, Enum& value,
                       std::span<const char* const> names, const std::string& help) {
  const std::vector<std::string> choices(names.begin(), names.end());
  return command
      .add_option_function<std::string>(
          name,
          [&value, choices](const std::string& text) {
            const auto at = std::find(choices.begin(), choices.end(), text);
            value = static_cast<Enum>(at - choices.begin());
          },
          help)
      ->check(CLI::IsMember(choices))
      ->type_name("")
      ->default_str(names[static_cast<std::size_t>(value)]);
}

}  // namespace sherd::cli
