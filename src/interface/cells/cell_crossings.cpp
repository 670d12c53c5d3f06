// Crossings from distances, or from the input.
#include "interface/cells/cell_crossings.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sherd {
namespace {

using Corners = std::array<double, 8>;

glm::dvec3 cornerAt(unsigned corner) {
  return {static_cast<double>(corner >> 2), static_cast<double>((corner >> 1) & 1),
          static_cast<double>(corner & 1)};
}

// The value at a corner of a function that is negative at corner `low`, positive at corner `high`
// and zero on the surface between their labels.
double between(const CellValues& values, unsigned low, unsigned high, std::size_t corner) {
  if (values.labels[low] == 0) return -1.0 * double{values.toSurface[corner]};
  if (values.labels[high] == 0) return double{values.toSurface[corner]};
  return double{values.toCut[low][corner]} - double{values.toCut[high][corner]};
}

// Gradient of the trilinear interpolant.
glm::dvec3 gradientAt(const Corners& f, const glm::dvec3& p) {
  const std::array<glm::dvec3, 2> weight{1.0 - p, p};  // of a corner's low and high coordinates
  glm::dvec3 g(0.0);
  for (std::size_t c = 0; c < 8; ++c) {
    const std::size_t i = c >> 2, j = (c >> 1) & 1, k = c & 1;
    const double x = weight[i].x, y = weight[j].y, z = weight[k].z;
    g += f[c] *
         glm::dvec3(i == 0 ? -y * z : y * z, j == 0 ? -x * z : x * z, k == 0 ? -x * y : x * y);
  }
  return g;
}

glm::dvec3 pointOn(const CellValues& values, unsigned low, unsigned high) {
  const double atLow = between(values, low, high, low);
  const double span = atLow - between(values, low, high, high);
  const double t = span != 0.0 ? std::clamp(atLow / span, 0.0, 1.0) : 0.5;
  return cornerAt(low) + t * (cornerAt(high) - cornerAt(low));
}

}  // namespace

glm::dvec3 normalAt(const CellValues& values, const Crossing& crossing) {
  Corners f;
  for (std::size_t c = 0; c < 8; ++c) f[c] = between(values, crossing.low, crossing.high, c);
  const glm::dvec3 gradient = gradientAt(f, crossing.plane.point);
  const double length = glm::length(gradient);
  return length > 0.0 ? gradient / length : glm::dvec3(0.0);
}

Crossings crossingsOf(const CellValues& values, const CellSheets& sheets, unsigned position,
                      std::span<const float> snapWeight) {
  Crossings found;
  std::array<std::size_t, 12> edges{};
  std::uint16_t one = 0, other = 0;  // the pair of labels, if there is only one
  bool isOnInput = true;
  for (std::size_t e = 0; e < 12; ++e) {
    if (sheets.positionOf[e] != position) continue;
    const unsigned low = kCellEdges[e][0], high = kCellEdges[e][1];
    const std::uint16_t a = std::min(values.labels[low], values.labels[high]),
                        b = std::max(values.labels[low], values.labels[high]);
    if (found.count > 0) found.onePair = found.onePair && a == one && b == other;
    one = a;
    other = b;
    found.snapWeight = std::max({found.snapWeight, snapWeight[a], snapWeight[b]});
    if (a == 0) ++found.outers;
    isOnInput = isOnInput && (a != 0 || values.onInput[e].has_value());
    edges[found.count] = e;
    found.all[found.count++] = {low, high, a == 0, values.labels[low] == 0, {}};
  }
  found.areOnInput = isOnInput && found.outers > 0;
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < found.count; ++i) {
    Crossing& crossing = found.all[i];
    if (crossing.isOuter && found.areOnInput) {
      const InputCrossing& input = *values.onInput[edges[i]];
      const glm::dvec3 low = cornerAt(crossing.low);
      crossing.plane = {low + input.at * (cornerAt(crossing.high) - low), input.normal};
      if (crossing.isLowOutside) crossing.plane.normal = -input.normal;
    } else {
      crossing.plane.point = pointOn(values, crossing.low, crossing.high);
    }
    sum += crossing.plane.point;
  }
  found.mean = sum / static_cast<double>(found.count);
  return found;
}

}  // namespace sherd
