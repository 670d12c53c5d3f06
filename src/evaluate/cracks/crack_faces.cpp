// Connected areas of a mesh, and where three of them meet.
#include "evaluate/cracks/crack_faces.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "base/union_find.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

constexpr double kSameFacesReach = 4.0;  // times the radius

/// A set of triangles with a common vertex or edge, as sorted pairs (vertex, face).
using VertexFaces = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

VertexFaces facesAtVertices(const TriangleMesh& mesh, std::span<const std::uint32_t> face) {
  VertexFaces result;
  result.reserve(3 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (face[i] == kNoFace) continue;
    for (int k = 0; k < 3; ++k) result.emplace_back(mesh.triangles[i][k], face[i]);
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

/// A point where three or more faces meet.
struct Meeting {
  glm::dvec3 point;
  std::span<const std::pair<std::uint32_t, std::uint32_t>> faces;  ///< ascending
};

std::vector<Meeting> meetings(const TriangleMesh& mesh, const VertexFaces& at) {
  std::vector<Meeting> result;
  for (std::size_t i = 0, end = 0; i < at.size(); i = end) {
    while (end < at.size() && at[end].first == at[i].first) ++end;
    if (end - i < 3) continue;
    result.push_back({mesh.vertices[at[i].first], std::span(at).subspan(i, end - i)});
  }
  return result;
}

std::size_t commonFaces(const Meeting& a, const Meeting& b) {
  std::size_t common = 0;
  for (std::size_t i = 0, k = 0; i < a.faces.size() && k < b.faces.size();) {
    const std::uint32_t first = a.faces[i].second, second = b.faces[k].second;
    common += first == second;
    i += first <= second;
    k += second <= first;
  }
  return common;
}

}  // namespace

std::vector<SharedEdge> sharedEdges(const TriangleMesh& mesh) {
  struct Side {
    std::uint32_t low, high, triangle;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      if (low != high) sides.push_back({low, high, i});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  std::vector<SharedEdge> edges;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const Side &a = sides[i - 1], &b = sides[i];
    if (a.low == b.low && a.high == b.high)
      edges.push_back({a.triangle, b.triangle, a.low, a.high});
  }
  return edges;
}

Areas areasOf(const TriangleMesh& mesh, std::span<const std::uint32_t> set,
              std::span<const std::uint32_t> group) {
  Areas areas;
  std::vector<std::uint32_t> number(set.size(), kNoFace);  // of a set, by its least triangle
  areas.ofTriangle.resize(set.size());
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (number[set[i]] == kNoFace) {
      number[set[i]] = static_cast<std::uint32_t>(areas.size.size());
      areas.size.push_back(0.0);
      areas.group.push_back(group[i]);
    }
    areas.ofTriangle[i] = number[set[i]];
    const glm::uvec3& t = mesh.triangles[i];
    areas.size[areas.ofTriangle[i]] +=
        areaOf({mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]});
  }
  return areas;
}

Areas connectedAreas(const TriangleMesh& mesh, std::span<const SharedEdge> edges,
                     std::span<const std::uint32_t> group) {
  UnionFind sets(mesh.triangles.size());
  for (const SharedEdge& e : edges) {
    if (group[e.a] == group[e.b]) sets.unite(e.a, e.b);
  }
  return areasOf(mesh, std::move(sets).all(), group);
}

namespace {

/// Gives each small area that touches a counted one to that with the longest common boundary.
///   counted  [areas] the counted area that an area is part of, or kNoFace
///   return   whether there was one
bool giveAway(const TriangleMesh& mesh, std::span<const SharedEdge> edges, const Areas& areas,
              std::vector<std::uint32_t>& counted) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> boundary;  // of a small, a counted one
  for (const SharedEdge& e : edges) {
    const std::uint32_t a = areas.ofTriangle[e.a], b = areas.ofTriangle[e.b];
    if ((areas.group[a] == 0) != (areas.group[b] == 0)) continue;
    if ((counted[a] == kNoFace) == (counted[b] == kNoFace)) continue;
    const auto key = counted[a] == kNoFace ? std::pair(a, counted[b]) : std::pair(b, counted[a]);
    boundary[key] += glm::distance(mesh.vertices[e.low], mesh.vertices[e.high]);
  }
  std::vector<double> longest(counted.size(), -1.0);
  for (const auto& [pair, length] : boundary) {
    if (length <= longest[pair.first]) continue;
    longest[pair.first] = length;
    counted[pair.first] = pair.second;
  }
  return !boundary.empty();
}

}  // namespace

CountedFaces countedFaces(const TriangleMesh& mesh, std::span<const SharedEdge> edges,
                          const Areas& areas, double least) {
  std::vector<std::uint32_t> counted(areas.size.size(), kNoFace);
  for (std::uint32_t i = 0; i < counted.size(); ++i) {
    if (areas.size[i] >= least) counted[i] = i;
  }
  while (giveAway(mesh, edges, areas, counted)) {
  }
  CountedFaces faces;
  std::vector<std::uint32_t> number(counted.size(), kNoFace);
  for (std::uint32_t i = 0; i < counted.size(); ++i) {
    if (counted[i] != i) continue;
    number[i] = static_cast<std::uint32_t>(faces.original.size());
    faces.original.push_back(areas.group[i] == 0);
    faces.size.push_back(areas.size[i]);
  }
  for (const std::uint32_t area : areas.ofTriangle) {
    const std::uint32_t into = counted[area];
    faces.ofTriangle.push_back(into == kNoFace ? kNoFace : number[into]);
  }
  return faces;
}

std::size_t countVertices(const TriangleMesh& mesh, std::span<const std::uint32_t> face,
                          double radius) {
  const VertexFaces at = facesAtVertices(mesh, face);
  std::vector<Meeting> points = meetings(mesh, at);
  std::sort(points.begin(), points.end(),
            [](const Meeting& a, const Meeting& b) { return a.point.x < b.point.x; });
  UnionFind vertices(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    for (std::uint32_t k = i + 1;
         k < points.size() && points[k].point.x - points[i].point.x <= kSameFacesReach * radius;
         ++k) {
      const double apart = glm::distance(points[i].point, points[k].point);
      if (apart <= radius ||
          (apart <= kSameFacesReach * radius && commonFaces(points[i], points[k]) >= 3)) {
        vertices.unite(i, k);
      }
    }
  }
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i) count += vertices.find(i) == i;
  return count;
}

std::size_t countLines(const TriangleMesh& mesh, std::span<const SharedEdge> edges,
                       std::span<const std::uint32_t> face, int axis, double length) {
  using Ends = std::pair<std::uint32_t, std::uint32_t>;
  std::map<Ends, std::vector<Ends>> lines;  // edges, by the faces that they separate
  for (const SharedEdge& e : edges) {
    if (face[e.a] == face[e.b] || face[e.a] == kNoFace || face[e.b] == kNoFace) continue;
    lines[std::minmax(face[e.a], face[e.b])].emplace_back(e.low, e.high);
  }
  std::size_t count = 0;
  for (const auto& [pair, parts] : lines) {
    std::map<std::uint32_t, std::pair<double, double>> extents;  // of a connected line
    std::vector<std::uint32_t> ends;
    for (const auto& [low, high] : parts) ends.insert(ends.end(), {low, high});
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    const auto indexOf = [&](std::uint32_t v) {
      return static_cast<std::uint32_t>(std::lower_bound(ends.begin(), ends.end(), v) -
                                        ends.begin());
    };
    UnionFind line(ends.size());
    for (const auto& [low, high] : parts) line.unite(indexOf(low), indexOf(high));
    for (std::uint32_t i = 0; i < ends.size(); ++i) {
      const double at = mesh.vertices[ends[i]][axis];
      const auto [known, fresh] = extents.try_emplace(line.find(i), at, at);
      known->second = {std::min(known->second.first, at), std::max(known->second.second, at)};
    }
    for (const auto& [first, extent] : extents) count += extent.second - extent.first >= length;
  }
  return count;
}

}  // namespace sherd
