// Options whose values are drawn at random for each fracture of a dataset.
#pragma once

#include <sherd/dataset.h>

#include <optional>
#include <string>
#include <vector>

namespace sherd::cli {

/// An option with a range, "low..high", or choices, "a|b|c".
struct DrawnOption {
  std::string name;                  ///< "--roughness"
  std::string low, high;             ///< ends of a range
  std::vector<std::string> choices;  ///< empty for a range

  /// Returns the value for one fracture: a choice, a whole number where both ends of the range are
  /// written without a decimal point, else a number with six digits.
  [[nodiscard]] std::string valueFor(std::uint64_t seed) const;
};

/// Returns the drawn option for a name and a value, or nullopt if the value is a single one.
[[nodiscard]] std::optional<DrawnOption> drawnOption(const std::string& name,
                                                     const std::string& value);

/// Draws values for one fracture, sets them in `options`, and returns their names and texts.
///   throws  CLI::ParseError a value is out of range or its option cannot be drawn
DrawnOptions drawInto(const std::vector<DrawnOption>& drawn, std::uint64_t seed,
                      FractureOptions& options);

/// Refuses options that cannot be drawn, such as those of files, and values out of range.
///   throws  CLI::ParseError
void checkDrawn(const std::vector<DrawnOption>& drawn, const FractureOptions& options);

}  // namespace sherd::cli
