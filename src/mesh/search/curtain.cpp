// A surface through a line that is drawn on a mesh, across what the mesh bounds.
#include "mesh/search/curtain.h"

#include <sherd/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <utility>

#include "base/infinity.h"
#include "mesh/search/nearest_on_triangle.h"
#include "mesh/vertex_normals.h"

namespace sherd {
namespace {

constexpr double kSteps = 256.0;           // of a line, along the longest side
constexpr std::size_t kMostSteps = 65536;  // of one line
constexpr int kWindow = 5;                 // steps to each side over which normals are averaged
constexpr double kCurtainMargin = 0.02;    // of the longest side, above and below the wall
constexpr double kFarthest = 0.1;          // of the longest side, from a line to the surface
constexpr double kSmoothCosine = 0.766;    // of 40 degrees
constexpr double kWithin = 0.1;            // of a wall: a line nearer to a surface lies on it
constexpr double kClosed = 1e-6;           // of the longest side, between the ends of a closed line
constexpr double kFocal = 0.9;             // of the way to where normals meet

using DrawnPoint = DrawnSurface::Point;

// Returns points of the line no more than a step apart, without the last of a closed line.
std::vector<glm::dvec3> resampled(std::span<const glm::dvec3> line, double step, bool isClosed) {
  double length = 0.0;
  for (std::size_t i = 1; i < line.size(); ++i) length += glm::distance(line[i - 1], line[i]);
  if (!(length > 0.0 && length < kInfinity)) {
    throw Error(ErrorCode::input, "has a line without a length");
  }
  step = std::max(step, length / static_cast<double>(kMostSteps));
  std::vector<glm::dvec3> points{line.front()};
  for (std::size_t i = 1; i < line.size(); ++i) {
    const double side = glm::distance(line[i - 1], line[i]);
    const double parts = std::max(std::ceil(side / step), 1.0);
    for (double k = 1.0; k <= parts; ++k) {
      points.push_back(line[i - 1] + k / parts * (line[i] - line[i - 1]));
    }
  }
  if (isClosed) points.pop_back();
  return points;
}

// A line on the surface.
struct Track {
  std::vector<DrawnPoint> points;
  bool isClosed = false;

  [[nodiscard]] std::size_t segments() const { return points.size() - (isClosed ? 0 : 1); }
  [[nodiscard]] const DrawnPoint& after(std::size_t i) const {
    return points[(i + 1) % points.size()];
  }
};

// Returns the closest point of the surface.  A line that runs within a thin wall stays on the side
// of the wall where it began, although the other one may be closer.
//   before  the point before on the track, or null
DrawnPoint closestBeside(const glm::dvec3& at, const DrawnPoint* before,
                         const DrawnSurface& surface) {
  const DrawnPoint own = surface.closest(at);
  if (before == nullptr || glm::dot(own.normal, before->normal) >= 0.0) return own;
  const DrawnPoint behind = surface.closest(own.position - surface.depthBelow(own) * own.normal);
  const bool isWithin =
      glm::distance(at, own.position) > kWithin * glm::distance(own.position, behind.position);
  return isWithin && glm::dot(behind.normal, before->normal) > 0.0 ? behind : own;
}

Track trackOf(std::span<const glm::dvec3> line, const DrawnSurface& surface) {
  const bool isClosed =
      line.size() > 2 && glm::distance(line.front(), line.back()) <= kClosed * surface.longest();
  Track track{{}, isClosed};
  double nearest = kInfinity;
  const double least = 1e-9 * surface.longest();
  for (const glm::dvec3& at : resampled(line, surface.longest() / kSteps, track.isClosed)) {
    const DrawnPoint* const before = track.points.empty() ? nullptr : &track.points.back();
    const DrawnPoint on = closestBeside(at, before, surface);
    nearest = std::min(nearest, glm::distance(at, on.position));
    const bool isNew =
        track.points.empty() || glm::distance(track.points.back().position, on.position) > least;
    if (isNew) track.points.push_back(on);
  }
  const auto isBack = [&] {
    return glm::distance(track.points.back().position, track.points.front().position) <= least;
  };
  while (track.isClosed && track.points.size() > 1 && isBack()) track.points.pop_back();
  if (nearest > kFarthest * surface.longest()) {
    throw Error(ErrorCode::input,
                "has a line far from the object; does it belong to another mesh?");
  }
  if (track.points.size() < (track.isClosed ? 3 : 2)) {
    throw Error(ErrorCode::input, "has a line that is a point of the surface");
  }
  return track;
}

// Averages normals along the line, so that they turn gradually where it crosses an edge.
void smoothNormals(Track& track) {
  const auto count = static_cast<std::ptrdiff_t>(track.points.size());
  std::vector<glm::dvec3> smooth;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    glm::dvec3 sum(0.0);
    for (std::ptrdiff_t k = -kWindow; k <= kWindow; ++k) {
      const std::ptrdiff_t at = track.isClosed ? ((i + k) % count + count) % count
                                               : std::clamp<std::ptrdiff_t>(i + k, 0, count - 1);
      const auto weight = static_cast<double>(kWindow + 1 - std::abs(k));
      sum += weight * track.points[static_cast<std::size_t>(at)].normal;
    }
    const glm::dvec3 unit = unitOrZero(sum);
    smooth.push_back(unit == glm::dvec3(0.0) ? track.points[static_cast<std::size_t>(i)].normal
                                             : unit);
  }
  for (std::size_t i = 0; i < smooth.size(); ++i) track.points[i].normal = smooth[i];
}

// Returns a point beyond an end of the line, straight on.
//   end, inner  the end, and a point some steps before it
DrawnPoint beyond(const DrawnPoint& end, const DrawnPoint& inner, double reach) {
  glm::dvec3 along = end.position - inner.position;
  along = unitOrZero(along - glm::dot(along, end.normal) * end.normal);
  return {end.position + reach * along, end.normal};
}

void extendEnds(Track& track, double reach) {
  if (track.isClosed) return;
  std::vector<DrawnPoint>& points = track.points;
  const std::size_t back = std::min<std::size_t>(kWindow, points.size() - 1);
  const DrawnPoint first = beyond(points.front(), points[back], reach);
  const DrawnPoint last = beyond(points.back(), points[points.size() - 1 - back], reach);
  points.insert(points.begin(), first);
  points.push_back(last);
}

// How far a normal is followed, above and below the surface.
struct Reach {
  double above = 0.0, below = 0.0;
};

// Normals that approach each other are followed less far than to where they meet.
std::vector<Reach> reachesOf(const Track& track, const DrawnSurface& surface) {
  const double margin = kCurtainMargin * surface.longest();
  std::vector<Reach> reaches;
  for (const DrawnPoint& point : track.points) {
    reaches.push_back({margin, surface.depthBelow(point) + margin});
  }
  for (std::size_t i = 0; i < track.segments(); ++i) {
    const DrawnPoint &a = track.points[i], &b = track.after(i);
    const glm::dvec3 step = b.position - a.position;
    const double growth = glm::dot(b.normal - a.normal, step) / glm::dot(step, step);
    if (growth == 0.0) continue;
    for (Reach* reach : {&reaches[i], &reaches[(i + 1) % reaches.size()]}) {
      double& toward = growth > 0.0 ? reach->below : reach->above;
      toward = std::min(toward, kFocal / std::abs(growth));
    }
  }
  return reaches;
}

}  // namespace

DrawnSurface::DrawnSurface(TriangleMesh mesh)
    : mesh_(std::move(mesh)), tree_(mesh_), longest_(longestSide(tree_.box())) {
  firstAround_.assign(mesh_.vertices.size() + 1, 0);
  for (const glm::uvec3& t : mesh_.triangles) {
    for (int k = 0; k < 3; ++k) ++firstAround_[t[k] + 1];
  }
  for (std::size_t v = 0; v + 1 < firstAround_.size(); ++v) firstAround_[v + 1] += firstAround_[v];
  around_.resize(3 * mesh_.triangles.size());
  std::vector<std::uint32_t> end(firstAround_.begin(), firstAround_.end() - 1);
  for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) around_[end[mesh_.triangles[i][k]]++] = i;
  }
}

// The mean of the triangles around the corner that continue this one smoothly.
glm::dvec3 DrawnSurface::cornerNormal(std::uint32_t triangle, int corner) const {
  const glm::dvec3 own = cornersOf(mesh_, mesh_.triangles[triangle]).normal;
  const std::uint32_t vertex = mesh_.triangles[triangle][corner];
  glm::dvec3 sum(0.0);
  for (std::uint32_t i = firstAround_[vertex]; i < firstAround_[vertex + 1]; ++i) {
    const glm::uvec3& t = mesh_.triangles[around_[i]];
    const Corners other = cornersOf(mesh_, t);
    if (glm::dot(other.normal, own) < kSmoothCosine) continue;
    for (int k = 0; k < 3; ++k) {
      if (t[k] == vertex) sum += other.angle[static_cast<std::size_t>(k)] * other.normal;
    }
  }
  return sum;
}

DrawnSurface::Point DrawnSurface::closest(const glm::dvec3& point) const {
  const TriangleTree::Nearest nearest = tree_.nearest(point, kInfinity);
  const std::array<glm::dvec3, 3> t = tree_.corners(nearest.triangle);
  const std::uint32_t triangle = tree_.source(nearest.triangle);
  const glm::dvec3 on = nearestOnTriangle(point, t[0], t[1], t[2]);
  glm::dvec3 normal(0.0);
  for (int k = 0; k < 3; ++k) {
    const auto b = static_cast<std::size_t>((k + 1) % 3), c = static_cast<std::size_t>((k + 2) % 3);
    const double weight = glm::length(glm::cross(t[b] - on, t[c] - on));
    if (weight > 0.0) normal += weight * unitOrZero(cornerNormal(triangle, k));
  }
  const glm::dvec3 unit = unitOrZero(normal);
  return {on, unit == glm::dvec3(0.0) ? cornersOf(mesh_, mesh_.triangles[triangle]).normal : unit};
}

double DrawnSurface::depthBelow(const DrawnPoint& point) const {
  const double below = tree_.firstHit(point.position, -point.normal, 1e-6 * longest_);
  return below < longest_ ? below : longest_;
}

TriangleMesh curtainOf(std::span<const glm::dvec3> line, const DrawnSurface& surface) {
  Track track = trackOf(line, surface);
  smoothNormals(track);
  std::vector<Reach> reaches = reachesOf(track, surface);
  if (!track.isClosed) {
    extendEnds(track, 2.0 * surface.longest());
    reaches.insert(reaches.begin(), reaches.front());
    reaches.push_back(reaches.back());
  }
  TriangleMesh strip;
  for (std::size_t i = 0; i < track.points.size(); ++i) {
    const DrawnPoint& at = track.points[i];
    strip.vertices.push_back(at.position + reaches[i].above * at.normal);
    strip.vertices.push_back(at.position);
    strip.vertices.push_back(at.position - reaches[i].below * at.normal);
  }
  for (std::size_t i = 0; i < track.segments(); ++i) {
    const auto here = static_cast<std::uint32_t>(3 * i);
    const auto next = static_cast<std::uint32_t>(3 * ((i + 1) % track.points.size()));
    for (std::uint32_t row = 0; row < 2; ++row) {
      strip.triangles.emplace_back(here + row, here + row + 1, next + row);
      strip.triangles.emplace_back(next + row, here + row + 1, next + row + 1);
    }
  }
  return strip;
}

}  // namespace sherd
