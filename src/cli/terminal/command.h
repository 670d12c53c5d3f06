// Registration of sub-commands, output, and number validation.
#pragma once

#include <sherd/error.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <functional>
#include <string>

namespace sherd::cli {

/// Runs after the command line is parsed.
using Action = std::function<void()>;

/// Each function adds a sub-command; parsing it sets `run`.
CLI::App* addFractureCommand(CLI::App& app, Action& run);
CLI::App* addDatasetCommand(CLI::App& app, Action& run);
CLI::App* addAssemblageCommand(CLI::App& app, Action& run);
void addMergeCommand(CLI::App& app, Action& run);
void addInspectCommand(CLI::App& app, Action& run);
void addConvertCommand(CLI::App& app, Action& run);
void addEvaluateCommand(CLI::App& app, Action& run);
void addRenderCommand(CLI::App& app, Action& run);
void addViewCommand(CLI::App& app, Action& run);
void addOptionsCommand(CLI::App& app, Action& run);
void addDevicesCommand(CLI::App& app, Action& run);
void addDoctorCommand(CLI::App& app, Action& run);

/// Writes results to standard output, control characters but line breaks escaped (printable); names
/// in plain text are escaped whole by the caller, so that they stay in their line.
///   throws  Error(output) it is closed or full; Error(cancelled)
void printResult(const std::string& text);

/// Writes one line to standard error, control characters escaped; failures are ignored.
void printMessage(const std::string& line);

/// The sentence for an allocation that fails.
inline constexpr const char* kNoMemory = "not enough memory; try a lower resolution (--resolution)";

/// Returns an error's sentence with the flags of its options: "...; try a higher resolution
/// (--resolution)".
[[nodiscard]] std::string sentenceOf(const Error& error);

/// Accepts whole decimal numbers from `low` to `high`.  CLI11's own conversion reads "-1" as 2^64-1
/// and "010" as eight, and saturates numbers out of range.
template <class T>
CLI::Validator wholeNumber(T low, T high) {
  const std::string range = std::to_string(low) + ".." + std::to_string(high);
  return CLI::Validator(
      [low, high, range](std::string& text) -> std::string {
        T value{};
        const char* end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, value);
        if (error != std::errc() || stop != end || value < low || value > high) {
          return "'" + text + "' is not a whole number in " + range;
        }
        text = std::to_string(value);
        return {};
      },
      range);
}

}  // namespace sherd::cli
