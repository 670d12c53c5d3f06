// Vertex positions from the crossings of a cell's edges and their tangent planes.
#include "surface/cell_vertex.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace sherd {
namespace {

// Distance of vertices from the cell's faces, so that vertices of two cells never coincide.
constexpr double kMargin = 0.005;

// Regularization: keeps the solution near the mean where planes are nearly parallel.
constexpr double kPull = 0.05;

// How far outside its cell the target of a boundary vertex may lie, and how often the target is
// projected onto the surface's plane and clamped to the allowed box.
constexpr double kMaxOutside = 0.5;
constexpr int kPasses = 8;

// Below 1, so that two sheets in one cell never coincide at its center.
constexpr double kMaxSnapWeight = 0.9;

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

struct Crossing {
  unsigned low = 0, high = 0;  // corners of the edge
  glm::dvec3 point{0.0};
  glm::dvec3 normal{0.0};
};

glm::dvec3 pointOn(const CellValues& values, unsigned low, unsigned high) {
  const double atLow = between(values, low, high, low);
  const double span = atLow - between(values, low, high, high);
  const double t = span != 0.0 ? std::clamp(atLow / span, 0.0, 1.0) : 0.5;
  return cornerAt(low) + t * (cornerAt(high) - cornerAt(low));
}

glm::dvec3 normalAt(const CellValues& values, const Crossing& crossing) {
  Corners f;
  for (std::size_t c = 0; c < 8; ++c) f[c] = between(values, crossing.low, crossing.high, c);
  const glm::dvec3 gradient = gradientAt(f, crossing.point);
  const double length = glm::length(gradient);
  return length > 0.0 ? gradient / length : glm::dvec3(0.0);
}

// The least-squares intersection of the planes, regularized towards `mean`.
glm::dvec3 leastSquaresPoint(const std::array<Crossing, 12>& crossings, std::size_t count,
                             const glm::dvec3& mean) {
  glm::dmat3 a(kPull);
  glm::dvec3 b(0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3& n = crossings[i].normal;
    const double offset = glm::dot(n, crossings[i].point - mean);
    a += glm::outerProduct(n, n);
    b += offset * n;
  }
  return mean + glm::inverse(a) * b;
}

glm::dvec3 clampedToCell(const glm::dvec3& p, double margin) {
  return glm::clamp(p, glm::dvec3(margin), glm::dvec3(1.0 - margin));
}

}  // namespace

CellVertex cellVertex(const CellValues& values, const CellSheets& sheets, unsigned position,
                      std::span<const float> snapWeight) {
  std::array<Crossing, 12> crossings;
  std::size_t count = 0;
  glm::dvec3 sum(0.0);
  std::uint16_t one = 0, other = 0;  // the pair of labels, if there is only one
  bool onePair = true, outer = false;
  float snap = 0.0f;
  for (std::size_t e = 0; e < 12; ++e) {
    if (sheets.positionOf[e] != position) continue;
    const unsigned low = kCellEdges[e][0], high = kCellEdges[e][1];
    const std::uint16_t a = std::min(values.labels[low], values.labels[high]),
                        b = std::max(values.labels[low], values.labels[high]);
    if (count > 0) onePair = onePair && a == one && b == other;
    one = a;
    other = b;
    outer = outer || a == 0;
    snap = std::max({snap, snapWeight[a], snapWeight[b]});
    crossings[count] = {low, high, pointOn(values, low, high)};
    sum += crossings[count].point;
    ++count;
  }
  const glm::dvec3 mean = sum / static_cast<double>(count);
  const glm::dvec3 center(0.5);
  if (!outer && snap > 0.0f) {
    const glm::dvec3 at = mean + kMaxSnapWeight * double{snap} * (center - mean);
    return {at, at};
  }
  if (onePair) {
    const glm::dvec3 at = clampedToCell(mean, kMargin);
    return {at, at};
  }
  // A boundary vertex lies on the original surface, which predates the crack.
  std::size_t outers = 0;
  glm::dvec3 outerSum(0.0), outward(0.0);
  for (std::size_t i = 0; i < count; ++i) {
    Crossing& crossing = crossings[i];
    crossing.normal = normalAt(values, crossing);
    const bool isLowOutside = values.labels[crossing.low] == 0;
    if (!isLowOutside && values.labels[crossing.high] != 0) continue;
    outerSum += crossing.point;
    outward += isLowOutside ? -crossing.normal : crossing.normal;
    ++outers;
  }
  const glm::dvec3 intersection = leastSquaresPoint(crossings, count, mean);
  const double length = glm::length(outward);
  const auto ontoSurface = [&](const glm::dvec3& p) {
    if (length == 0.0) return p;
    const glm::dvec3 n = outward / length;
    return p - glm::dot(p - outerSum / static_cast<double>(outers), n) * n;
  };
  glm::dvec3 target = clampedToCell(intersection, -kMaxOutside);
  for (int pass = 0; pass < kPasses; ++pass)
    target = clampedToCell(ontoSurface(target), -kMaxOutside);
  return {clampedToCell(intersection, kMargin), target};
}

}  // namespace sherd
