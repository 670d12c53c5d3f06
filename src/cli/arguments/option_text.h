// Parsing and validation of option values.
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

/// Accepts finite numbers above 0.
[[nodiscard]] CLI::Validator aboveZero();

/// Accepts finite numbers from `low` to `high`; `range` describes them in --help.
[[nodiscard]] CLI::Validator numberBetween(double low, double high, const std::string& range);

/// Returns the bytes of a size: a whole or decimal number above 0, optional blanks, and optionally
/// K, M, G, T or P (powers of 1024; also KB, KiB) or B, in any case.  Returns nullopt for any other
/// text, and for 2^64 bytes or more.
[[nodiscard]] std::optional<std::uint64_t> bytesIn(const std::string& text);

/// Accepts sizes, and converts them to bytes.
[[nodiscard]] CLI::Validator size();

/// Throws CLI::ValidationError "option: 'text' is not <expected>".
[[noreturn]] void refuse(const std::string& option, const std::string& text,
                         const std::string& expected);

}  // namespace sherd::cli
