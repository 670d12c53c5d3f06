// Options of a fracture that are drawn afresh for each fracture of a dataset.
#pragma once

#include <sherd/dataset.h>

#include <optional>
#include <string>
#include <vector>

namespace sherd::cli {

/// An option whose value is a range, "low..high", or one of several, "a|b|c".
struct DrawnOption {
  std::string name;                  ///< "--roughness"
  std::string low, high;             ///< of a range
  std::vector<std::string> choices;  ///< else

  /// The value for one fracture.  Of a range whose ends are whole numbers, written without a point,
  /// a whole number; else any number.
  [[nodiscard]] std::string valueFor(std::uint64_t seed) const;
};

/// The option that two arguments make, if it is one that is drawn.
[[nodiscard]] std::optional<DrawnOption> drawnOption(const std::string& name,
                                                     const std::string& value);

/// Set options as drawn for one fracture.
///   throws  CLI::ValidationError and the like; for a value of `drawn` that no option takes
DrawnOptions drawInto(const std::vector<DrawnOption>& drawn, std::uint64_t seed,
                      FractureOptions& options);

/// Refuse what cannot be drawn: options that shape the solid or the files, ends out of range.
///   throws  CLI::ValidationError
void checkDrawn(const std::vector<DrawnOption>& drawn, const FractureOptions& options);

}  // namespace sherd::cli
