// Names and sizes of what a mesh's coordinates mean.
#pragma once

#include <sherd/mesh.h>

#include <optional>
#include <string>
#include <string_view>

namespace sherd {

/// A unit of length with a name.
struct LengthUnit {
  const char* name;
  double meters;
};
inline constexpr LengthUnit kLengthUnits[] = {{"mm", 0.001}, {"cm", 0.01},   {"m", 1.0},
                                              {"km", 1000},  {"in", 0.0254}, {"ft", 0.3048}};

/// Whether a length can be a unit's: masses of objects up to 1e37 units long are finite.
[[nodiscard]] inline bool isUnit(double meters) { return meters >= 1e-30 && meters <= 1e30; }

/// Returns the length of the unit with a name.
[[nodiscard]] std::optional<double> metersOf(std::string_view unit);

/// Returns the unit with a length, up to rounding of a float; null: it has no name.
[[nodiscard]] const LengthUnit* unitOf(double meters);

/// Returns a length in meters, or that of the named unit which it is up to rounding of a float.
[[nodiscard]] double exactUnit(double meters);

/// Returns a length in words: "495 mm", in its own unit if that has a name and the number is
/// neither long nor small.
[[nodiscard]] std::string lengthText(double length, double metersPerUnit);

/// Returns the length of a box along the upward axis.
[[nodiscard]] double heightOf(const Box& box, char up);

}  // namespace sherd
