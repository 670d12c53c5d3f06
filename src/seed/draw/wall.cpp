// The walls of a solid: their middle, their thickness, and ways along them.
#include "seed/draw/wall.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "voxelize/distance.h"
#include "voxelize/region.h"

namespace sherd {

Walls::Walls(const Solid& solid) : solid_(solid) {
  if (solid.distance) valueAt_ = valuesOf(solid.distance);
}

// In voxels, linear between the voxels' centers.
double Walls::distance(const IndexPoint& point) const {
  const glm::dvec3 low = glm::floor(point), f = point - low;
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner >> 2, y = corner >> 1 & 1, z = corner & 1;
    const double share =
        (x == 1 ? f.x : 1.0 - f.x) * (y == 1 ? f.y : 1.0 - f.y) * (z == 1 ? f.z : 1.0 - f.z);
    sum += share * valueAt_({static_cast<int>(low.x) + x, static_cast<int>(low.y) + y,
                             static_cast<int>(low.z) + z});
  }
  return sum / solid_.frame.voxelSize;
}

glm::dvec3 Walls::gradient(const IndexPoint& point) const {
  glm::dvec3 slope(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0.0);
    step[axis] = 1.0;
    slope[axis] = 0.5 * (distance(point + step) - distance(point - step));
  }
  return slope;
}

// Returns the point a voxel away along an axis that is nearest to the surface, if one is nearer.
std::optional<IndexPoint> Walls::towardsSurface(const IndexPoint& point) const {
  std::optional<IndexPoint> best;
  double greatest = distance(point) + 0.25;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double step : {1.0, -1.0}) {
      glm::dvec3 beside = point;
      beside[axis] += step;
      const double value = distance(beside);
      if (value <= greatest) continue;
      greatest = value;
      best = beside;
    }
  }
  return best;
}

std::optional<IndexPoint> Walls::onSurface(const IndexPoint& point) const {
  if (solid_.region && solid_.region->boundary() != nullptr) {
    return solid_.region->onSurface(point);
  }
  glm::dvec3 at = point;
  constexpr int kSteps = 4;
  for (int i = 0; i < kSteps; ++i) {
    const glm::dvec3 slope = gradient(at);
    const double square = glm::dot(slope, slope);
    if (square < 0.1) {  // far from the surface, or in the middle of a wall: leave the middle
      const std::optional<IndexPoint> beside = i == 0 ? towardsSurface(at) : std::nullopt;
      if (!beside) return {};
      at = *beside;
      continue;
    }
    at -= glm::clamp(distance(at), -2.0, 2.0) / std::sqrt(square) * (slope / std::sqrt(square));
  }
  return at;
}

std::optional<Wall> Walls::at(const IndexPoint& point, double most) const {
  if (!valueAt_) return {};
  constexpr double kFar = 1e6;  // voxels
  if (!(std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z)}) < kFar)) return {};
  const std::optional<IndexPoint> surface = onSurface(point);
  if (!surface || glm::length(*surface - point) > most) return {};
  const glm::dvec3 slope = gradient(*surface);
  if (glm::length(slope) < 0.1) return {};
  Wall wall{*surface, glm::normalize(slope)};
  // Values of the level set are at least a voxel's away from what they are here.
  constexpr double kStart = 0.5, kLeastStep = 0.25;
  double length = kStart, value = distance(*surface - kStart * wall.normal);
  while (value < 0.0) {
    if (length > most) return {};
    const double step = std::max(-value, kLeastStep);
    const double next = distance(*surface - (length + step) * wall.normal);
    if (next >= 0.0) {
      length += step * value / (value - next);
      break;
    }
    length += step;
    value = next;
  }
  if (length > most) return {};
  wall.thickness = length;
  wall.middle = *surface - 0.5 * length * wall.normal;
  return wall;
}

glm::dvec3 Walls::normalAt(const IndexPoint& point) const {
  if (!valueAt_) return glm::dvec3(0.0);
  const glm::dvec3 slope = gradient(onSurface(point).value_or(point));
  const double length = glm::length(slope);
  return length > 0.1 ? slope / length : glm::dvec3(0.0);
}

std::vector<IndexPoint> Walls::walk(const IndexPoint& from, const glm::dvec3& direction,
                                    const std::vector<double>& lengths) const {
  constexpr double kMostAway = 0.35;  // of a step: beyond an edge the surface falls away
  constexpr double kMostBend = 0.8;   // cosine of the angle between two steps
  std::vector<IndexPoint> points;
  glm::dvec3 at = from, along = glm::normalize(direction);
  double walked = 0.0;
  while (points.size() < lengths.size()) {
    const double step = std::min(lengths[points.size()] - walked, 1.0);
    const glm::dvec3 ahead = at + step * along;
    const std::optional<IndexPoint> next = onSurface(ahead);
    if (!next || glm::length(*next - ahead) > kMostAway * std::max(step, 0.5)) break;
    const glm::dvec3 moved = *next - at;
    const double advance = glm::length(moved);
    if (step > 0.5) {
      if (advance < kMostBend * step || glm::dot(moved, along) < kMostBend * advance) break;
      along = moved / advance;
    }
    at = *next;
    walked += step;
    if (walked >= lengths[points.size()] - 1e-9) points.push_back(at);
  }
  return points;
}

IndexPoint wallMiddle(const Walls& walls, const IndexPoint& point, double most) {
  const std::optional<Wall> wall = walls.at(point, most);
  return wall ? wall->middle : point;
}

double thinFor(const Solid& solid, std::size_t pieces) {
  const double size = solid.frame.voxelSize;
  const bool isKnown = solid.region && solid.report.fill == Fill::winding;
  const double ofMesh = isKnown ? solid.report.meshVolume / (size * size * size) : 0.0;
  const double volume = ofMesh > 0.0 ? ofMesh : static_cast<double>(solid.voxels);
  return std::cbrt(volume / static_cast<double>(std::max<std::size_t>(pieces, 1)));
}

namespace {

constexpr std::uint64_t kThinSamples = 64;

// Returns the centers of the middle voxels of 64 parts of a solid's voxels, by their number.
std::vector<glm::dvec3> middleVoxels(const LeafBlocks& blocks) {
  std::vector<glm::dvec3> points;
  const std::uint64_t all = blocks.insideVoxels();
  std::uint64_t seen = 0;
  for (std::size_t word = 0; word < blocks.inside.size(); ++word) {
    const std::uint64_t bits = blocks.inside[word];
    const auto count = static_cast<std::uint64_t>(std::popcount(bits));
    while (points.size() < kThinSamples) {
      const std::uint64_t next = (2 * points.size() + 1) * all / (2 * kThinSamples);
      if (next >= seen + count) break;
      std::uint64_t left = bits;
      for (std::uint64_t i = seen; i < next; ++i) left &= left - 1;
      const openvdb::Coord voxel =
          blocks.voxelAt(word * 64 + static_cast<std::size_t>(std::countr_zero(left)));
      points.emplace_back(voxel.x(), voxel.y(), voxel.z());
    }
    seen += count;
  }
  return points;
}

// The index mirrored at the radix point, in a base.
double mirrored(std::uint64_t index, std::uint64_t base) {
  double sum = 0.0, digit = 1.0;
  for (; index > 0; index /= base) {
    digit /= static_cast<double>(base);
    sum += digit * static_cast<double>(index % base);
  }
  return sum;
}

// Returns points inside a mesh, the first 64 of Halton's sequence in its box: the same at every
// resolution.  Fewer where the box is nearly empty.
std::vector<glm::dvec3> pointsInside(const Solid& solid) {
  constexpr std::uint64_t kMostDraws = 1 << 14;
  constexpr double kSure = 1.5;  // voxels, as in Candidates
  const SolidRegion& region = *solid.region;
  const auto distanceAt = valuesOf(solid.distance);
  std::vector<glm::dvec3> points;
  for (std::uint64_t i = 1; i < kMostDraws && points.size() < kThinSamples; ++i) {
    const glm::dvec3 unit(mirrored(i, 2), mirrored(i, 3), mirrored(i, 5));
    const glm::dvec3 point = unit * region.sides() - 0.5;
    const glm::dvec3 near = glm::floor(point + 0.5);
    const double distance =
        distanceAt({static_cast<int>(near.x), static_cast<int>(near.y), static_cast<int>(near.z)}) /
        solid.frame.voxelSize;
    if (distance > kSure || (distance > -kSure && !region.contains(point))) continue;
    points.push_back(point);
  }
  return points;
}

// Returns whether the wall at a point inside a mesh is thinner than `most`: by the mesh, through
// surfaces that lie within the solid.
bool isInThinWall(const SolidRegion& region, const glm::dvec3& point, double most) {
  const glm::dvec3 away = point - region.onSurface(point);
  const double depth = glm::length(away);
  if (depth > most) return false;
  if (depth == 0.0) return true;
  const glm::dvec3 inward = away / depth;
  const glm::dvec3& sides = region.sides();
  const double step = 1e-4 * std::max({sides.x, sides.y, sides.z});
  glm::dvec3 at = point;
  for (int i = 0; i < 16; ++i) {
    const std::optional<IndexPoint> hit = region.firstHit(at, inward);
    if (!hit || depth + glm::distance(point, *hit) > most) return false;
    at = *hit + step * inward;
    if (!region.contains(at)) return true;
  }
  return true;
}

}  // namespace

bool isThin(const Solid& solid, std::size_t pieces) {
  if (pieces < 2 || !solid.distance || solid.voxels == 0) return false;
  const double most = thinFor(solid, pieces);
  std::vector<glm::dvec3> points;
  std::size_t thick = 0;
  if (solid.region && solid.region->boundary() != nullptr) points = pointsInside(solid);
  if (points.size() == kThinSamples) {
    for (const glm::dvec3& point : points)
      thick += isInThinWall(*solid.region, point, most) ? 0 : 1;
    return thick <= kThinSamples / 4;
  }
  const Walls walls(solid);
  points = middleVoxels(*solid.blocks);
  for (const glm::dvec3& point : points) thick += walls.at(point, most) ? 0 : 1;
  return thick <= kThinSamples / 4;
}

SeedsOn resolved(SeedsOn on, const Solid& solid, std::size_t pieces) {
  if (on != SeedsOn::automatic) return on;
  return isThin(solid, pieces) ? SeedsOn::wall : SeedsOn::volume;
}

}  // namespace sherd
