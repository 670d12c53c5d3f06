// Bodies of a mesh that share vertices, taken apart.
#include "mesh/repair/bodies_apart.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "base/union_find.h"

namespace sherd {
namespace {

constexpr double kSameAngle = 1e-9;    // radians: faces in one plane, by different triangles
constexpr double kFlatVolume = 1e-13;  // of the cube of a box's diagonal: only rounding

// The use of an edge by a triangle of a group of objects.
struct FaceSide {
  std::uint32_t low = 0, high = 0, group = 0, triangle = 0, tip = 0;
  bool isForward = false;
};

// Returns [groups] whether a group is inside out.
std::vector<bool> areInverted(const TriangleMesh& mesh, const std::vector<std::uint32_t>& group) {
  std::vector<double> volumes(std::size_t{*std::ranges::max_element(group)} + 1, 0.0);
  const glm::dvec3& from = mesh.vertices[mesh.triangles.front().x];
  for (std::size_t t = 0; t < group.size(); ++t) {
    const glm::uvec3& c = mesh.triangles[t];
    volumes[group[t]] += glm::dot(mesh.vertices[c.x] - from,
                                  glm::cross(mesh.vertices[c.y] - from, mesh.vertices[c.z] - from));
  }
  std::vector<bool> inverted;
  for (const double own : volumes) inverted.push_back(own < 0.0);
  return inverted;
}

// As of groups that are oriented outwards.
std::vector<FaceSide> sortedHalves(const TriangleMesh& mesh,
                                   const std::vector<std::uint32_t>& group) {
  const std::vector<bool> inverted = areInverted(mesh, group);
  std::vector<FaceSide> halves;
  halves.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const glm::uvec3& c = mesh.triangles[t];
      const std::uint32_t from = c[k], to = c[(k + 1) % 3];
      if (from == to) continue;
      halves.push_back({std::min(from, to), std::max(from, to), group[t], t, c[(k + 2) % 3],
                        (from < to) != inverted[group[t]]});
    }
  }
  std::sort(halves.begin(), halves.end(), [](const FaceSide& a, const FaceSide& b) {
    return std::tie(a.low, a.high, a.group, a.triangle) <
           std::tie(b.low, b.high, b.group, b.triangle);
  });
  return halves;
}

// Calls visit(uses) for the uses of each edge by each group.
template <class Visit>
void forEachEdgeOfGroups(std::span<const FaceSide> halves, const Visit& visit) {
  for (std::size_t i = 0, end = 0; i < halves.size(); i = end) {
    const FaceSide& first = halves[i];
    const auto isSame = [&](const FaceSide& h) {
      return h.low == first.low && h.high == first.high && h.group == first.group;
    };
    while (end < halves.size() && isSame(halves[end])) ++end;
    visit(halves.subspan(i, end - i));
  }
}

bool isBalanced(std::span<const FaceSide> uses) {
  const auto forward =
      std::ranges::count_if(uses, [](const FaceSide& use) { return use.isForward; });
  return 2 * static_cast<std::size_t>(forward) == uses.size();
}

// Returns [triangles] the number of a closed object and 1, or 0 for all others together.
std::vector<std::uint32_t> groupsOf(const TriangleMesh& mesh,
                                    std::span<const std::uint32_t> objects) {
  std::vector<std::uint32_t> group(mesh.triangles.size(), 0);
  if (objects.size() != group.size()) return group;
  for (std::size_t t = 0; t < group.size(); ++t) group[t] = objects[t] + 1;
  std::vector<bool> isOpen(std::size_t{*std::ranges::max_element(group)} + 1, false);
  const std::vector<FaceSide> halves = sortedHalves(mesh, group);
  forEachEdgeOfGroups(halves, [&](std::span<const FaceSide> uses) {
    if (!isBalanced(uses)) isOpen[uses.front().group] = true;
  });
  for (std::uint32_t& g : group) {
    if (isOpen[g]) g = 0;
  }
  return group;
}

// A triangle at an edge.  Seen against the edge's direction the inside begins after one that uses
// it backward, and ends at one that uses it forward.
struct Spoke {
  double angle = 0.0;
  bool ends = false;
  std::uint32_t triangle = 0;
};

std::vector<Spoke> spokesOf(const TriangleMesh& mesh, std::span<const FaceSide> uses) {
  const glm::dvec3& from = mesh.vertices[uses.front().low];
  const glm::dvec3 along = mesh.vertices[uses.front().high] - from;
  const glm::dvec3 away =
      std::abs(along.x) < std::abs(along.y) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::cross(along, away), v = glm::cross(along, u) / glm::length(along);
  std::vector<Spoke> spokes;
  for (const FaceSide& use : uses) {
    const glm::dvec3 to = mesh.vertices[use.tip] - from;
    double angle = std::atan2(glm::dot(to, v), glm::dot(to, u));
    if (!spokes.empty()) angle -= spokes.front().angle;
    if (angle < -kSameAngle) angle += 2.0 * std::numbers::pi;
    if (angle > 2.0 * std::numbers::pi - kSameAngle) angle -= 2.0 * std::numbers::pi;
    spokes.push_back({angle, use.isForward, use.triangle});
  }
  spokes.front().angle = 0.0;
  return spokes;
}

// Sorts spokes around their edge.  At one angle those come first that end an inside: bodies that
// share a face lie on both sides of it.
void sortAround(std::vector<Spoke>& spokes) {
  std::ranges::sort(spokes, {}, &Spoke::angle);
  for (std::size_t i = 1; i < spokes.size(); ++i) {
    if (spokes[i].angle - spokes[i - 1].angle < kSameAngle) spokes[i].angle = spokes[i - 1].angle;
  }
  std::ranges::sort(spokes, [](const Spoke& a, const Spoke& b) {
    return std::tuple(a.angle, !a.ends, a.triangle) < std::tuple(b.angle, !b.ends, b.triangle);
  });
  // From where the fewest insides overlap: each begins before it ends.
  int depth = 0, least = 0;
  std::size_t start = 0;
  for (std::size_t i = 0; i < spokes.size(); ++i) {
    depth += spokes[i].ends ? -1 : 1;
    if (depth < least) {
      least = depth;
      start = i + 1;
    }
  }
  std::rotate(spokes.begin(), spokes.begin() + static_cast<std::ptrdiff_t>(start), spokes.end());
}

// Pairs the triangles of each inside at an edge, in the order in which these begin: first those of
// one sheet, which edges of two triangles connect.
//   sheet  [triangles]
template <class Unite>
void pairAround(std::vector<Spoke> spokes, const std::vector<std::uint32_t>& sheet,
                const Unite& unite) {
  std::vector<bool> isTaken(spokes.size(), false);
  for (const bool isOneSheet : {true, false}) {
    for (std::size_t i = 0; i < spokes.size(); ++i) {
      if (spokes[i].ends || isTaken[i]) continue;
      for (std::size_t k = 0; k < spokes.size(); ++k) {
        if (!spokes[k].ends || isTaken[k]) continue;
        if (isOneSheet && sheet[spokes[i].triangle] != sheet[spokes[k].triangle]) continue;
        isTaken[i] = isTaken[k] = true;
        unite(spokes[i].triangle, spokes[k].triangle);
        break;
      }
    }
  }
}

// Returns [triangles] the name of each one's body.
std::vector<std::uint32_t> bodyNames(const TriangleMesh& mesh,
                                     std::span<const std::uint32_t> objects) {
  UnionFind bodies(mesh.triangles.size());
  const std::vector<FaceSide> halves = sortedHalves(mesh, groupsOf(mesh, objects));
  const auto isOfSheets = [](std::span<const FaceSide> uses) {
    return uses.size() > 2 && isBalanced(uses);
  };
  forEachEdgeOfGroups(halves, [&](std::span<const FaceSide> uses) {
    if (isOfSheets(uses)) return;
    for (const FaceSide& use : uses) bodies.unite(uses.front().triangle, use.triangle);
  });
  const std::vector<std::uint32_t> sheet = UnionFind(bodies).all();
  forEachEdgeOfGroups(halves, [&](std::span<const FaceSide> uses) {
    if (!isOfSheets(uses)) return;
    std::vector<Spoke> spokes = spokesOf(mesh, uses);
    sortAround(spokes);
    pairAround(std::move(spokes), sheet,
               [&](std::uint32_t a, std::uint32_t b) { bodies.unite(a, b); });
  });
  return std::move(bodies).all();
}

// Returns [triangles], by the names of bodies, whether these enclose no volume.
std::vector<bool> areFlat(const TriangleMesh& mesh, const std::vector<std::uint32_t>& body) {
  std::vector<double> volumes(body.size(), 0.0);
  std::vector<Box> boxes(body.size(), {glm::dvec3(std::numeric_limits<double>::infinity()),
                                       glm::dvec3(-std::numeric_limits<double>::infinity())});
  for (std::size_t t = 0; t < body.size(); ++t) {
    const glm::dvec3& from = mesh.vertices[mesh.triangles[body[t]].x];
    const glm::uvec3& c = mesh.triangles[t];
    Box& box = boxes[body[t]];
    for (int k = 0; k < 3; ++k) {
      box.min = glm::min(box.min, mesh.vertices[c[k]]);
      box.max = glm::max(box.max, mesh.vertices[c[k]]);
    }
    volumes[body[t]] += glm::dot(mesh.vertices[c.x] - from,
                                 glm::cross(mesh.vertices[c.y] - from, mesh.vertices[c.z] - from)) /
                        6.0;
  }
  std::vector<bool> flat(body.size(), false);
  for (std::size_t t = 0; t < body.size(); ++t) {
    if (body[t] != t) continue;
    flat[t] = std::abs(volumes[t]) <=
              kFlatVolume * std::pow(glm::distance(boxes[t].min, boxes[t].max), 3);
  }
  return flat;
}

}  // namespace

TriangleMesh withBodiesApart(TriangleMesh mesh, std::span<const std::uint32_t> objects) {
  if (mesh.triangles.empty()) return mesh;
  const std::vector<std::uint32_t> body = bodyNames(mesh, objects);
  const std::vector<bool> isFlat = areFlat(mesh, body);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> uses;  // vertex, body
  for (std::size_t t = 0; t < body.size(); ++t) {
    if (isFlat[body[t]]) continue;
    for (int k = 0; k < 3; ++k) uses.emplace_back(mesh.triangles[t][k], body[t]);
  }
  std::ranges::sort(uses);
  uses.erase(std::unique(uses.begin(), uses.end()), uses.end());
  std::vector<std::uint32_t> number(uses.size());
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const bool isFirst = i == 0 || uses[i - 1].first != uses[i].first;
    number[i] = isFirst ? uses[i].first : static_cast<std::uint32_t>(mesh.vertices.size());
    if (!isFirst) mesh.vertices.push_back(glm::dvec3(mesh.vertices[uses[i].first]));
  }
  for (std::size_t t = 0; t < body.size(); ++t) {
    if (isFlat[body[t]]) continue;
    for (int k = 0; k < 3; ++k) {
      const std::pair use{mesh.triangles[t][k], body[t]};
      const auto at = std::ranges::lower_bound(uses, use) - uses.begin();
      mesh.triangles[t][k] = number[static_cast<std::size_t>(at)];
    }
  }
  return mesh;
}

}  // namespace sherd
