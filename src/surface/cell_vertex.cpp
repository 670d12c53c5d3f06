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

// Corner values of a function that is negative at corner `low`, positive at corner `high` and zero
// on the surface between their labels.
Corners between(const CellValues& values, unsigned low, unsigned high) {
  Corners f;
  const bool outer = values.labels[low] == 0 || values.labels[high] == 0;
  const double sign = values.labels[low] == 0 ? -1.0 : 1.0;
  for (std::size_t c = 0; c < 8; ++c) {
    f[c] = outer ? sign * double{values.toSurface[c]}
                 : double{values.toCut[low][c]} - double{values.toCut[high][c]};
  }
  return f;
}

// Gradient of the trilinear interpolant.
glm::dvec3 gradientAt(const Corners& f, const glm::dvec3& p) {
  glm::dvec3 g(0.0);
  for (unsigned c = 0; c < 8; ++c) {
    const glm::dvec3 at = cornerAt(c);
    glm::dvec3 weight, slope;
    for (int axis = 0; axis < 3; ++axis) {
      weight[axis] = at[axis] > 0 ? p[axis] : 1.0 - p[axis];
      slope[axis] = at[axis] > 0 ? 1.0 : -1.0;
    }
    g += f[c] * glm::dvec3(slope.x * weight.y * weight.z, weight.x * slope.y * weight.z,
                           weight.x * weight.y * slope.z);
  }
  return g;
}

struct Crossing {
  glm::dvec3 point, normal;
};

Crossing crossing(const CellValues& values, unsigned low, unsigned high) {
  const Corners f = between(values, low, high);
  const double span = f[low] - f[high];
  const double t = span != 0.0 ? std::clamp(f[low] / span, 0.0, 1.0) : 0.5;
  const glm::dvec3 point = cornerAt(low) + t * (cornerAt(high) - cornerAt(low));
  const glm::dvec3 gradient = gradientAt(f, point);
  const double length = glm::length(gradient);
  return {point, length > 0.0 ? gradient / length : glm::dvec3(0.0)};
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
  std::size_t count = 0, outers = 0;
  glm::dvec3 sum(0.0), outerSum(0.0), outward(0.0);
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
    crossings[count] = crossing(values, low, high);
    sum += crossings[count].point;
    if (a == 0) {
      outerSum += crossings[count].point;
      outward += values.labels[low] == 0 ? -crossings[count].normal : crossings[count].normal;
      ++outers;
    }
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
