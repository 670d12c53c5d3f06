// Counts the defects of a mesh and measures its angles.
#include <sherd/evaluate.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "base/union_find.h"

namespace sherd {
namespace {

// Twice the area over the longest side squared, below which a triangle is degenerate.  Rounding to
// single precision leaves more to a triangle with area.
constexpr double kNoArea = 1e-12;

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kSliverDegrees = 10.0;

/// A side of a triangle.
struct Side {
  std::uint32_t low, high;  ///< its vertices
  std::uint32_t triangle;
  bool forward;  ///< from low to high

  auto edge() const { return std::pair(low, high); }
};

bool twoEqual(const glm::uvec3& t) { return t.x == t.y || t.y == t.z || t.z == t.x; }

std::vector<Side> sidesOf(const TriangleMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    if (twoEqual(t)) continue;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[(k + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), i, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return sides;
}

/// Calls visit(sides) for each edge.
template <class Visit>
void forEachEdge(std::span<const Side> sides, Visit visit) {
  while (!sides.empty()) {
    const auto end = std::find_if(sides.begin(), sides.end(),
                                  [&](const Side& s) { return s.edge() != sides.front().edge(); });
    const auto uses = static_cast<std::size_t>(end - sides.begin());
    visit(sides.first(uses));
    sides = sides.subspan(uses);
  }
}

void countEdges(MeshQuality& quality, std::span<const Side> sides) {
  bool balanced = true;
  forEachEdge(sides, [&](std::span<const Side> edge) {
    const std::size_t uses = edge.size();
    const auto forward = static_cast<std::size_t>(
        std::count_if(edge.begin(), edge.end(), [](const Side& s) { return s.forward; }));
    balanced &= 2 * forward == uses;
    quality.boundaryEdges += uses == 1;
    quality.flippedEdges += uses == 2 && forward != 1;
    quality.nonManifoldEdges += uses > 2;
  });
  quality.closed = balanced && !sides.empty();
}

/// Sets of corners, three for each triangle; corners unite where triangles share an edge.
class Fans {
 public:
  explicit Fans(const TriangleMesh& mesh) : mesh_(mesh), fans_(3 * mesh.triangles.size()) {}

  void unite(const Side& a, const Side& b) {
    for (const std::uint32_t vertex : {a.low, a.high}) {
      fans_.unite(corner(a.triangle, vertex), corner(b.triangle, vertex));
    }
  }

  /// Returns the number of fans round each vertex, [vertices]; 0 for an unused one.
  std::vector<std::uint32_t> perVertex() {
    std::vector<std::uint32_t> count(mesh_.vertices.size(), 0);
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      const glm::uvec3& t = mesh_.triangles[i];
      if (twoEqual(t)) continue;
      for (unsigned k = 0; k < 3; ++k)
        count[t[static_cast<int>(k)]] += fans_.find(3 * i + k) == 3 * i + k;
    }
    return count;
  }

 private:
  std::uint32_t corner(std::uint32_t triangle, std::uint32_t vertex) const {
    const glm::uvec3& t = mesh_.triangles[triangle];
    return 3 * triangle + (t.x == vertex ? 0u : t.y == vertex ? 1u : 2u);
  }

  const TriangleMesh& mesh_;
  UnionFind fans_;  ///< [3 * triangles]
};

void countVertices(MeshQuality& quality, const TriangleMesh& mesh, std::span<const Side> sides) {
  Fans fans(mesh);
  forEachEdge(sides, [&](std::span<const Side> edge) {
    for (const Side& side : edge.subspan(1)) fans.unite(edge.front(), side);
  });
  for (const std::uint32_t count : fans.perVertex()) {
    quality.vertices += count > 0;
    quality.nonManifoldVertices += count > 1;
  }
}

std::size_t duplicates(const TriangleMesh& mesh) {
  std::vector<std::array<std::uint32_t, 3>> corners;
  corners.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    if (twoEqual(t)) continue;
    std::array<std::uint32_t, 3> sorted{t.x, t.y, t.z};
    std::sort(sorted.begin(), sorted.end());
    corners.push_back(sorted);
  }
  std::sort(corners.begin(), corners.end());
  std::size_t count = 0;
  for (std::size_t i = 1; i < corners.size(); ++i) count += corners[i] == corners[i - 1];
  return count;
}

/// Returns the smallest angle in degrees, or -1 for a degenerate triangle.
double smallestAngle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 side[3] = {b - a, c - b, a - c};
  const double across = glm::length(glm::cross(side[0], side[1]));
  double longest = 0.0, smallest = std::numbers::pi;
  for (int k = 0; k < 3; ++k) {
    longest = std::max(longest, glm::dot(side[k], side[k]));
    smallest = std::min(smallest, std::atan2(across, -glm::dot(side[k], side[(k + 1) % 3])));
  }
  return across > kNoArea * longest ? smallest * kDegrees : -1.0;
}

void measureAngles(MeshQuality& quality, const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return;
  double sum = 0.0;
  std::size_t slivers = 0;
  quality.smallestAngle = 60.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const double measured =
        smallestAngle(mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]);
    quality.degenerateTriangles += measured < 0.0;
    const double angle = std::clamp(measured, 0.0, 60.0);
    sum += angle;
    slivers += angle < kSliverDegrees;
    quality.smallestAngle = std::min(quality.smallestAngle, angle);
    const auto bin = static_cast<std::size_t>(angle * MeshQuality::kAngleBins / 60.0);
    ++quality.smallestAngles[std::min(bin, MeshQuality::kAngleBins - 1)];
  }
  const auto count = static_cast<double>(mesh.triangles.size());
  quality.meanSmallestAngle = sum / count;
  quality.sliverShare = static_cast<double>(slivers) / count;
}

}  // namespace

MeshQuality meshQuality(const TriangleMesh& mesh) {
  MeshQuality quality;
  quality.triangles = mesh.triangles.size();
  quality.components = meshComponents(mesh).count;
  quality.volume = volume(mesh);
  const std::vector<Side> sides = sidesOf(mesh);
  countEdges(quality, sides);
  countVertices(quality, mesh, sides);
  quality.duplicateTriangles = duplicates(mesh);
  measureAngles(quality, mesh);
  return quality;
}

}  // namespace sherd
