// The union of the bodies of one mesh, by the winding numbers in its arrangement.
#include "intersect/arrange/unite.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/infinity.h"
#include "base/progress_part.h"
#include "base/union_find.h"
#include "intersect/arrange/arrangement.h"
#include "intersect/arrange/winding_of_patches.h"
#include "intersect/crossing_point.h"
#include "intersect/self_crossings.h"
#include "mesh/positions.h"
#include "mesh/search/boxes.h"
#include "mesh/search/near_boxes.h"
#include "mesh/search/triangle_tree.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr const char* kRounding = "rounding makes parts of the bodies that overlap or touch cross";

// Grids for meshes whose union can't be rounded, bits of the longest side, down to about what
// single precision has.  Faces that are equal but for rounding come to one plane, or far enough
// apart for double precision.
constexpr std::array<int, 3> kGridBits{40, 32, 24};
// Triangles thinner than this part of the longest side are a reason to use them too.
constexpr int kThinBits = 44;
constexpr int kMostRounds = 4;  // of uniting the rounded union with itself
// Most meshes need one pass; each further one takes as large a part of what is left of the stage.
constexpr double kPassShare = 0.8;

// The triangles that have an area, of vertices at different positions.
TriangleMesh withArea(const TriangleMesh& mesh) {
  TriangleMesh out{mesh.vertices, {}};
  const std::vector<std::uint32_t> position = firstAtPosition(mesh.vertices);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& c = mesh.triangles[t];
    const glm::uvec3 corner(position[c.x], position[c.y], position[c.z]);
    if (areCollinear({mesh.vertices[c.x], mesh.vertices[c.y], mesh.vertices[c.z]})) continue;
    out.triangles.push_back(corner);
    out.source.push_back(t);
  }
  return out;
}

// A triangle of the union, by the numbers of the mesh's vertices and, after those, of new ones.
struct Kept {
  glm::uvec3 corner{0};
  std::uint32_t source = 0;
  std::uint8_t isPart = 0;  // of a triangle that others meet
};

// Gives points that are rounded to one position one number, and leaves out triangles that vanish by
// that: those with two equal corners, and pairs back to back.
void mergeRounded(const PointSet& points, std::vector<Kept>& all) {
  std::vector<glm::dvec3> rounded;
  for (std::uint32_t p = 0; p < points.count(); ++p) rounded.push_back(points.rounded(p));
  const std::vector<std::uint32_t> first = firstAtPosition(rounded);
  std::map<std::array<std::uint32_t, 3>, std::vector<std::uint32_t>> partsAt;
  std::vector<bool> isGone(all.size(), false);
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    glm::uvec3& c = all[i].corner;
    if (all[i].isPart == 0) continue;
    c = {first[c.x], first[c.y], first[c.z]};
    isGone[i] = c.x == c.y || c.y == c.z || c.z == c.x;
    std::array<std::uint32_t, 3> sorted{c.x, c.y, c.z};
    std::sort(sorted.begin(), sorted.end());
    if (!isGone[i]) partsAt[sorted].push_back(i);
  }
  const auto isEven = [&](std::uint32_t i) {
    const glm::uvec3& c = all[i].corner;
    return ((c.x > c.y ? 1 : 0) + (c.y > c.z ? 1 : 0) + (c.x > c.z ? 1 : 0)) % 2 == 0;
  };
  for (const auto& [corners, own] : partsAt) {
    std::array<std::vector<std::uint32_t>, 2> sides;
    for (const std::uint32_t i : own) sides[isEven(i) ? 1 : 0].push_back(i);
    const std::size_t pairs = std::min(sides[0].size(), sides[1].size());
    for (std::size_t k = 0; k < pairs; ++k) isGone[sides[0][k]] = isGone[sides[1][k]] = true;
  }
  std::size_t i = 0;
  std::erase_if(all, [&](const Kept&) { return isGone[i++]; });
}

// The mesh of the vertices that are used, the given ones first.
TriangleMesh meshOf(const std::vector<Kept>& kept, const PointSet& points) {
  std::vector<std::uint32_t> number(points.count(), kNone);
  for (const Kept& t : kept) {
    for (int k = 0; k < 3; ++k) number[t.corner[k]] = 0;
  }
  TriangleMesh out;
  for (std::uint32_t p = 0; p < number.size(); ++p) {
    if (number[p] == kNone) continue;
    number[p] = static_cast<std::uint32_t>(out.vertices.size());
    out.vertices.push_back(points.rounded(p));
  }
  for (const Kept& t : kept) {
    out.triangles.emplace_back(number[t.corner.x], number[t.corner.y], number[t.corner.z]);
    out.source.push_back(t.source);
  }
  return out;
}

// The components of triangles connected over edges; nothing if an edge has more than two triangles.
std::optional<MeshComponents> componentsOf(const TriangleMesh& mesh) {
  std::vector<std::array<std::uint32_t, 3>> edges;  // ends, triangle
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]});
      edges.push_back({low, high, t});
    }
  }
  std::sort(edges.begin(), edges.end());
  const auto isSame = [&](std::size_t i, std::size_t j) {
    return j < edges.size() && edges[i][0] == edges[j][0] && edges[i][1] == edges[j][1];
  };
  UnionFind sets(mesh.triangles.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (isSame(i, i + 2)) return std::nullopt;
    if (isSame(i, i + 1)) sets.unite(edges[i][2], edges[i + 1][2]);
  }
  MeshComponents components{std::move(sets).all(), 0};
  for (std::uint32_t t = 0; t < components.ofTriangle.size(); ++t) {
    std::uint32_t& own = components.ofTriangle[t];
    own = own == t ? components.count++ : components.ofTriangle[own];
  }
  return components;
}

// Marks the triangles of components whose boxes meet that of another component.
std::vector<std::uint8_t> nearOthers(const TriangleMesh& mesh, const MeshComponents& components) {
  std::vector<Box> boxes(components.count, {glm::dvec3(kInfinity), glm::dvec3(-kInfinity)});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& c = mesh.triangles[t];
    const Box own = boxOf({mesh.vertices[c.x], mesh.vertices[c.y], mesh.vertices[c.z]});
    Box& box = boxes[components.ofTriangle[t]];
    box = {glm::min(box.min, own.min), glm::max(box.max, own.max)};
  }
  const std::vector<std::uint8_t> isNear = meetingOthers(boxes);
  std::vector<std::uint8_t> marks;
  marks.reserve(mesh.triangles.size());
  for (const std::uint32_t c : components.ofTriangle) marks.push_back(isNear[c]);
  return marks;
}

// The union; where rounding makes its parts cross, with that failure and the mesh that crosses.
UnitedMesh unitedOnce(const TriangleMesh& mesh, const Progress* progress) {
  const TriangleMesh whole = withArea(mesh);
  if (whole.triangles.empty()) return {.failure = "no triangle of the mesh has an area"};
  const auto pairs = selfCrossings(whole.vertices, whole.triangles, progress);
  PointSet points(whole.vertices);
  std::vector<std::uint8_t> isDivided;
  const Progress dividing = partOf(progress, 0.2, 0.7);
  Arrangement arrangement =
      arrangementOf(whole.vertices, whole.triangles, pairs, points, isDivided, &dividing);
  if (!arrangement.failure.empty()) return {.failure = std::move(arrangement.failure)};
  const std::vector<ArrangedTriangle>& parts = arrangement.parts;
  const auto winding = windingInFront(whole, TriangleTree(whole), parts, points, progress);
  if (!winding) return {.failure = "the bodies that overlap or touch are not closed"};
  reportProgress(progress, kUniteStage, 0.9);
  std::vector<Kept> kept;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const ArrangedTriangle& part = parts[p];
    const int inFront = (*winding)[p], behind = inFront + static_cast<int>(part.multiplicity);
    if (inFront > 0 || behind < 1) continue;
    kept.push_back({part.corner, whole.source[part.source], isDivided[part.source]});
  }
  mergeRounded(points, kept);
  if (kept.empty()) return {.failure = "the mesh has no inside"};
  UnitedMesh united{.mesh = meshOf(kept, points),
                    .isChanged = !pairs.empty() || kept.size() != mesh.triangles.size()};
  std::vector<std::uint8_t> isPart;
  for (const Kept& t : kept) isPart.push_back(t.isPart);
  const auto crossings =
      selfCrossings(united.mesh.vertices, united.mesh.triangles, progress, {.of = isPart});
  if (!crossings.empty()) united.failure = kRounding;
  return united;
}

bool isCrossedByRounding(const UnitedMesh& united) { return united.failure == kRounding; }

// Whether a mesh has new triangles that are thinner than a length: a cut through such is likely to
// fail by rounding.
bool hasThinner(const TriangleMesh& mesh, const TriangleMesh& source, double length) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3 &own = mesh.triangles[t], &from = source.triangles[mesh.source[t]];
    const std::array<glm::dvec3, 3> corners = positionsOf(mesh.vertices, own);
    if (glm::length(areaNormal(corners)) >= length * longestEdge(corners)) continue;
    if (corners != positionsOf(source.vertices, from)) return true;
  }
  return false;
}

// The mesh with vertices on a grid of size * 2^-bits, for a size rounded to a power of two: those
// of triangles that cross others, or are as close to such as a step of the grid.
TriangleMesh snapped(const TriangleMesh& mesh, double size, int bits, const Progress* progress) {
  const double step = std::ldexp(1.0, std::ilogb(size) - bits);
  const TriangleTree tree(mesh);
  const auto boxAt = [&](std::uint32_t t) {
    const glm::uvec3& c = mesh.triangles[t];
    return boxOf({mesh.vertices[c.x], mesh.vertices[c.y], mesh.vertices[c.z]});
  };
  std::vector<bool> isCrossed(mesh.triangles.size(), false), isMoved(mesh.vertices.size(), false);
  for (const auto& pair : selfCrossings(mesh.vertices, mesh.triangles, progress)) {
    for (const std::uint32_t t : pair) isCrossed[t] = true;
  }
  for (std::uint32_t t = 0; t < isCrossed.size(); ++t) {
    if (!isCrossed[t]) continue;
    for (const std::uint32_t near : tree.meeting(widened(boxAt(t), 2.0 * step))) {
      for (int k = 0; k < 3; ++k) isMoved[mesh.triangles[tree.source(near)][k]] = true;
    }
  }
  TriangleMesh out{mesh.vertices, mesh.triangles};
  for (std::size_t v = 0; v < isMoved.size(); ++v) {
    if (isMoved[v]) out.vertices[v] = glm::round(out.vertices[v] / step) * step;
  }
  return out;
}

}  // namespace

bool componentsMeet(const TriangleMesh& mesh, const Progress* progress) {
  const std::optional<MeshComponents> components = componentsOf(mesh);
  if (!components) return true;
  if (components->count < 2) return false;
  const std::vector<std::uint8_t> isNear = nearOthers(mesh, *components);
  if (std::find(isNear.begin(), isNear.end(), 1) == isNear.end()) return false;
  if (!selfCrossings(mesh.vertices, mesh.triangles, progress,
                     {.of = isNear, .source = components->ofTriangle})
           .empty()) {
    return true;
  }
  // All that is left are components within others.
  TriangleMesh whole = withArea(mesh);
  std::vector<ArrangedTriangle> parts;
  for (std::uint32_t t = 0; t < whole.triangles.size(); ++t) {
    if (isNear[whole.source[t]] != 0) parts.push_back({whole.triangles[t], t});
  }
  const auto winding =
      windingInFront(whole, TriangleTree(whole), parts, PointSet(whole.vertices), progress);
  return winding && std::any_of(winding->begin(), winding->end(), [](int w) { return w != 0; });
}

UnitedMesh unite(const TriangleMesh& mesh, const Progress* progress) {
  reportProgress(progress, kUniteStage, 0.0);
  double left = 1.0;  // of the stage
  const auto pass = [&](const TriangleMesh& of) {
    const double from = 1.0 - left;
    left *= 1.0 - kPassShare;
    const Progress part = partOf(progress, from, 1.0 - left);
    return unitedOnce(of, &part);
  };
  UnitedMesh united = pass(mesh);
  const double size = longestSide(bounds(mesh)), thin = std::ldexp(size, -kThinBits);
  const bool isWhole = !united.isChanged && united.failure.empty();
  for (const int bits : kGridBits) {
    if (isWhole || (united.failure.empty() && !hasThinner(united.mesh, mesh, thin))) break;
    UnitedMesh onGrid = pass(snapped(mesh, size, bits, progress));
    for (int round = 1; round < kMostRounds && isCrossedByRounding(onGrid); ++round) {
      UnitedMesh again = pass(onGrid.mesh);
      for (std::uint32_t& source : again.mesh.source) source = onGrid.mesh.source[source];
      onGrid = std::move(again);
    }
    if (!onGrid.failure.empty() && united.failure.empty()) break;
    united = std::move(onGrid);
    united.isChanged = true;
  }
  reportProgress(progress, kUniteStage, 1.0);
  return united;
}

}  // namespace sherd
