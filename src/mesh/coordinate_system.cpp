// Names and sizes of what a mesh's coordinates mean.
#include "mesh/coordinate_system.h"

#include <cmath>

#include "base/text/formatted.h"

namespace sherd {
namespace {

constexpr double kFloatRounding = 1e-6;  // relative, of a unit's length

}  // namespace

std::optional<double> metersOf(std::string_view unit) {
  for (const LengthUnit& known : kLengthUnits) {
    if (unit == known.name) return known.meters;
  }
  return {};
}

const LengthUnit* unitOf(double meters) {
  for (const LengthUnit& known : kLengthUnits) {
    if (std::abs(meters - known.meters) <= kFloatRounding * known.meters) return &known;
  }
  return nullptr;
}

double exactUnit(double meters) {
  const LengthUnit* const known = unitOf(meters);
  return known != nullptr ? known->meters : meters;
}

std::string lengthText(double length, double metersPerUnit) {
  constexpr double kLeast = 0.01, kMost = 10000.0;
  const LengthUnit* const own = unitOf(metersPerUnit);
  if (own != nullptr && length >= kLeast && length < kMost) {
    return formatted("%.4g %s", length, own->name);
  }
  const double meters = length * metersPerUnit;
  if (meters >= kMost) return formatted("%.4g km", meters / 1000.0);
  if (meters >= 1.0 || meters == 0.0) return formatted("%.4g m", meters);
  return formatted("%.4g mm", meters * 1000.0);
}

double heightOf(const Box& box, char up) {
  const int axis = up - 'x';
  return box.max[axis] - box.min[axis];
}

}  // namespace sherd
