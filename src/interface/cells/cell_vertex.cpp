// Vertex positions from the crossings of a cell's edges and their tangent planes.
#include "interface/cells/cell_vertex.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <optional>

namespace sherd {
namespace {

// Regularization: keeps the solution near the mean where planes are nearly parallel.
constexpr double kPull = 0.05;

// How far outside its cell the target of a boundary vertex may lie, and how often the target is
// projected onto the surface's plane and clamped to the allowed box.
constexpr double kMaxOutside = 0.5;
constexpr int kPasses = 8;

// Below 1, so that two sheets in one cell never coincide at its center.
constexpr double kMaxSnapWeight = 0.9;

// The least-squares intersection of the planes, regularized towards their mean.
glm::dvec3 leastSquaresPoint(const Crossings& crossings) {
  glm::dmat3 a(kPull);
  glm::dvec3 b(0.0);
  for (const Crossing& crossing : crossings.span()) {
    const glm::dvec3& n = crossing.plane.normal;
    a += glm::outerProduct(n, n);
    b += glm::dot(n, crossing.plane.point - crossings.mean) * n;
  }
  return crossings.mean + glm::inverse(a) * b;
}

glm::dvec3 clampedToCell(const glm::dvec3& p, double margin) {
  return glm::clamp(p, glm::dvec3(margin), glm::dvec3(1.0 - margin));
}

// The plane of the original surface in a cell; without one, a normal of 0.
TangentPlane outerPlane(const Crossings& crossings) {
  glm::dvec3 sum(0.0), outward(0.0);
  for (const Crossing& crossing : crossings.span()) {
    if (!crossing.isOuter) continue;
    sum += crossing.plane.point;
    outward += crossing.isLowOutside ? -crossing.plane.normal : crossing.plane.normal;
  }
  const double length = glm::length(outward);
  if (length == 0.0) return {};
  return {sum / static_cast<double>(crossings.outers), outward / length};
}

// A boundary vertex lies on the original surface, which predates the crack.
CellVertex onSurface(const Crossings& crossings, const glm::dvec3& intersection) {
  const TangentPlane plane = outerPlane(crossings);
  glm::dvec3 target = clampedToCell(intersection, -kMaxOutside);
  for (int pass = 0; pass < kPasses; ++pass) {
    target -= glm::dot(target - plane.point, plane.normal) * plane.normal;
    target = clampedToCell(target, -kMaxOutside);
  }
  return {clampedToCell(intersection, kCellMargin), target, 1, plane.normal};
}

// On a crease or corner of the input there is no one plane to project onto.  The vertex moves there
// from the mean of the crossings as far as triangles allow: on the crease they may cross others,
// where cracks meet it at a small angle.
std::optional<CellVertex> creaseOfBoundary(const Crossings& crossings) {
  const TangentPlanes outer(crossings, true), all(crossings, false);
  const PositionBox cell = cellBox(kCellMargin);
  const int rank = creasePoint(outer.span(), crossings.mean, cell).rank;
  if (rank == 1) return std::nullopt;
  const glm::dvec3 at = creasePoint(all.span(), crossings.mean, cell).at;
  return CellVertex{clampedToCell(crossings.mean, kCellMargin), at,
                    static_cast<std::uint8_t>(rank)};
}

// Where surfaces of several pairs of labels meet.
CellVertex boundaryVertex(const CellValues& values, Crossings crossings) {
  for (Crossing& crossing : crossings.span()) {
    if (!crossing.isOuter || !crossings.areOnInput)
      crossing.plane.normal = normalAt(values, crossing);
  }
  if (crossings.areOnInput) {
    if (const std::optional<CellVertex> crease = creaseOfBoundary(crossings)) return *crease;
  }
  const glm::dvec3 intersection = leastSquaresPoint(crossings);
  return onSurface(crossings, intersection);
}

}  // namespace

CellVertex cellVertex(const CellValues& values, const CellSheets& sheets, unsigned position,
                      std::span<const float> snapWeight) {
  const Crossings crossings = crossingsOf(values, sheets, position, snapWeight);
  const glm::dvec3 &mean = crossings.mean, center(0.5);
  if (crossings.outers == 0 && crossings.snapWeight > 0.0f) {
    const glm::dvec3 at = mean + kMaxSnapWeight * double{crossings.snapWeight} * (center - mean);
    return {at, at};
  }
  if (!crossings.onePair) return boundaryVertex(values, crossings);
  const glm::dvec3 at = clampedToCell(mean, kCellMargin);
  return {at, at};
}

}  // namespace sherd
