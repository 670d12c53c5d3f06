// Crossings of a cell's edges, and where their planes meet.
#include "surface/cell_vertex.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace sherd {
namespace {

// Vertices stay off the cell's faces, so that those of two cells never fall together.
constexpr double kMargin = 0.005;

// Pulls the solution to the mean where planes are nearly parallel.
constexpr double kPull = 0.05;

// How far beyond its cell a rim may want to lie, and how often a place is moved to the surface's
// plane and back into the box of places it may have.
constexpr double kBeyond = 0.5;
constexpr int kRounds = 8;

// Two sheets in one cell must not fall together there either.
constexpr double kMostStairs = 0.9;

using Corners = std::array<double, 8>;

glm::dvec3 cornerAt(unsigned corner) {
  return {static_cast<double>(corner >> 2), static_cast<double>((corner >> 1) & 1),
          static_cast<double>(corner & 1)};
}

// A function that is negative at the corner of label `low` and positive at that of `high`, zero on
// the surface between.
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

// The point nearest to all planes, in the least squares, pulled to `mean`.
glm::dvec3 meeting(const std::array<Crossing, 12>& crossings, std::size_t count,
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

glm::dvec3 within(const glm::dvec3& p, double margin) {
  return glm::clamp(p, glm::dvec3(margin), glm::dvec3(1.0 - margin));
}

}  // namespace

CellVertex cellVertex(const CellValues& values, const CellSheets& sheets, unsigned position,
                      std::span<const float> stairs) {
  std::array<Crossing, 12> crossings;
  std::size_t count = 0, outers = 0;
  glm::dvec3 sum(0.0), outerSum(0.0), outward(0.0);
  std::uint16_t one = 0, other = 0;  // the pair of labels, while there is only one
  bool onePair = true, outer = false;
  float keep = 0.0f;
  for (std::size_t e = 0; e < 12; ++e) {
    if (sheets.positionOf[e] != position) continue;
    const unsigned low = kCellEdges[e][0], high = kCellEdges[e][1];
    const std::uint16_t a = std::min(values.labels[low], values.labels[high]),
                        b = std::max(values.labels[low], values.labels[high]);
    if (count > 0) onePair = onePair && a == one && b == other;
    one = a;
    other = b;
    outer = outer || a == 0;
    keep = std::max({keep, stairs[a], stairs[b]});
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
  const glm::dvec3 centre(0.5);
  if (!outer && keep > 0.0f) {
    const glm::dvec3 at = mean + kMostStairs * double{keep} * (centre - mean);
    return {at, at};
  }
  if (onePair) {
    const glm::dvec3 at = within(mean, kMargin);
    return {at, at};
  }
  // On a rim the original surface comes first: it was there before the crack.
  const glm::dvec3 meets = meeting(crossings, count, mean);
  const double length = glm::length(outward);
  const auto ontoSurface = [&](const glm::dvec3& p) {
    if (length == 0.0) return p;
    const glm::dvec3 n = outward / length;
    return p - glm::dot(p - outerSum / static_cast<double>(outers), n) * n;
  };
  glm::dvec3 wanted = within(meets, -kBeyond);
  for (int round = 0; round < kRounds; ++round) wanted = within(ontoSurface(wanted), -kBeyond);
  return {within(meets, kMargin), wanted};
}

}  // namespace sherd
