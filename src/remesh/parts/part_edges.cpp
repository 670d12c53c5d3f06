// Fragments that touch themselves along edges, parted there.
#include "remesh/parts/part_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "base/cancel_flag.h"
#include "base/union_find.h"
#include "intersect/self_crossings.h"
#include "mesh/edges.h"
#include "mesh/positions.h"
#include "mesh/search/triangle_tree.h"
#include "remesh/vertex_numbers.h"

namespace sherd {
namespace {

// Vertices move by at most this share of the shortest edge or height there.
constexpr double kOfShortest = 0.25;

// How a sheet can be moved: into the fragment; out of it, as around a notch; towards what is around
// it, as at the tip of a needle, whose faces lean on each other; or away from that.  Further ways
// are parts of these.
enum class Way { inwards, outwards, together, apart };
constexpr int kWays = 4, kMostWays = 4 * kWays;

// Sheets that only have a vertex at an edge's end may stay where they are.
constexpr int kStays = kMostWays;

// How often ways are searched for all places.
constexpr int kMostRounds = 3;

// Of so many places at most: each takes up to some dozen tests of the faces near all.
constexpr std::size_t kMostPlaces = 64;

using Position = std::array<double, 3>;

// An edge by the positions of its ends, the lower first, and its fragment.
struct TouchingEdge {
  std::uint32_t fragment = 0;
  std::array<Position, 2> ends{};

  TouchingEdge(std::uint32_t of, const Position& a, const Position& b)
      : fragment(of), ends{std::min(a, b), std::max(a, b)} {}
  auto operator<=>(const TouchingEdge&) const = default;
};

Position pointOf(const glm::dvec3& p) { return {p.x, p.y, p.z}; }

// The mesh whose vertices are those that are first at their positions.
TriangleMesh merged(const TriangleMesh& mesh) {
  TriangleMesh one;
  one.vertices = mesh.vertices;
  one.triangles = mesh.triangles;
  const std::vector<std::uint32_t> first = firstAtPosition(mesh.vertices);
  for (glm::uvec3& t : one.triangles) t = {first[t.x], first[t.y], first[t.z]};
  return one;
}

// Calls visit(edge) for edges of the original surface that have more than two triangles.
template <class Visit>
void forEachTouching(const LabeledMesh& labeled, Visit visit) {
  const TriangleMesh one = merged(labeled.mesh);
  std::vector<bool> isOutside(one.vertices.size(), false);
  for (std::size_t t = 0; t < one.triangles.size(); ++t) {
    for (int k = 0; k < 3 && labeled.other[t] == 0; ++k) isOutside[one.triangles[t][k]] = true;
  }
  forEachEdge(one, [&](const EdgeUse& edge) {
    const bool isOnOutside = isOutside[edge.low] && isOutside[edge.high];
    if (isOnOutside && edge.forward + edge.backward > 2) visit(edge);
  });
}

// The vertices of all fragments at some positions.  Those that cracks connect move together.
class Touching {
 public:
  Touching(std::vector<LabeledMesh>& meshes, const std::set<TouchingEdge>& edges)
      : meshes_(meshes) {
    std::set<Position> positions;
    for (const TouchingEdge& edge : edges) positions.insert(edge.ends.begin(), edge.ends.end());
    for (std::uint32_t f = 0; f < meshes.size(); ++f) addNodes(f, positions);
    connect(edges);
  }

  // Moves all sheets but one at each place.
  void part(double distance) {
    distance_ = distance;
    std::map<Position, std::vector<std::uint32_t>> sheets;  // names of sheets, by position
    for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
      std::vector<std::uint32_t>& own = sheets[pointOf(nodes_[n].at)];
      if (const std::uint32_t name = sheetOf_[n]; std::ranges::find(own, name) == own.end()) {
        own.push_back(name);
      }
    }
    for (auto& [at, names] : sheets) {
      if (names.size() < 2) continue;
      // That with the most triangles stays.
      std::ranges::stable_sort(
          names, [&](std::uint32_t a, std::uint32_t b) { return corners_[a] > corners_[b]; });
      for (const std::uint32_t name : names) placeOf_[name] = static_cast<int>(places_.size());
      places_.push_back({names});
      move(places_.back());
    }
    findNear();
  }

  // Moves all sheets by a way.
  void moveBy(int way) {
    std::ranges::fill(ways_, way);
    for (const Place& place : places_) move(place);
  }

  // Moves sheets otherwise: all by the way that lets the fewest faces cross others, and then place
  // by place where that leaves fewer.
  void search(const Progress* progress) {
    int best = 0;
    std::size_t least = std::numeric_limits<std::size_t>::max();
    for (int way = 0; way < kMostWays && least > 0; ++way) {
      moveBy(way);
      const std::size_t count = crossings(progress);
      if (count >= least) continue;
      least = count;
      best = way;
    }
    moveBy(best);
    for (int round = 0; round < kMostRounds && least > 0; ++round) {
      std::set<int> crossed;
      std::size_t count = crossings(progress, &crossed);
      if (crossed.size() > kMostPlaces) return;
      for (const int place : crossed) {
        if (count > 0) count = improve(places_[static_cast<std::size_t>(place)], count, progress);
      }
      if (count == least) return;
      least = count;
    }
  }

  // Whether faces at moved vertices cross others of their fragment.
  [[nodiscard]] bool isCrossed(const Progress* progress) const {
    for (std::uint32_t f = 0; f < meshes_.size(); ++f) {
      const TriangleMesh& mesh = meshes_[f].mesh;
      std::vector<std::uint8_t> isMoved = movedOf(f, mesh.triangles);
      if (std::ranges::find(isMoved, 1) == isMoved.end()) continue;
      // Sheets that still touch at a vertex do not cross.
      const TriangleMesh one = merged(mesh);
      if (!selfCrossings(one.vertices, one.triangles, progress, {.of = isMoved}).empty())
        return true;
    }
    return false;
  }

 private:
  struct Node {
    std::uint32_t fragment = 0, vertex = 0;
    glm::dvec3 at{0.0};  // before it moves
  };

  void addNodes(std::uint32_t f, const std::set<Position>& positions) {
    const std::vector<glm::dvec3>& vertices = meshes_[f].mesh.vertices;
    for (std::uint32_t v = 0; v < vertices.size(); ++v) {
      if (!positions.contains(pointOf(vertices[v]))) continue;
      number_[{f, v}] = static_cast<std::uint32_t>(nodes_.size());
      nodes_.push_back({f, v, vertices[v]});
    }
  }

  // Sheets at one position.
  struct Place {
    std::vector<std::uint32_t> sheets;
    std::size_t stays = 0;  // index of the sheet that does not move
  };

  // [triangles] whether they have a moved vertex.
  [[nodiscard]] std::vector<std::uint8_t> movedOf(std::uint32_t f,
                                                  const std::vector<glm::uvec3>& triangles) const {
    std::vector<std::uint8_t> isMoved;
    for (const glm::uvec3& t : triangles) {
      isMoved.push_back(moved_.contains({f, t.x}) || moved_.contains({f, t.y}) ||
                        moved_.contains({f, t.z}));
    }
    return isMoved;
  }

  // Finds the triangles that those with nodes may cross.
  void findNear() {
    near_.resize(meshes_.size());
    std::vector<std::vector<std::uint32_t>> own(meshes_.size());
    for (const auto& [vertex, node] : number_) own[vertex.first].push_back(vertex.second);
    for (std::uint32_t f = 0; f < meshes_.size(); ++f) {
      if (own[f].empty()) continue;
      const TriangleMesh& mesh = meshes_[f].mesh;
      const TriangleTree tree(mesh);
      std::set<std::uint32_t> near;
      for (const glm::uvec3& t : mesh.triangles) {
        const auto isNode = [&](std::uint32_t v) { return number_.contains({f, v}); };
        if (!isNode(t.x) && !isNode(t.y) && !isNode(t.z)) continue;
        const std::vector<glm::dvec3>& v = mesh.vertices;
        const Box box{glm::min(v[t.x], glm::min(v[t.y], v[t.z])) - 2.0 * distance_,
                      glm::max(v[t.x], glm::max(v[t.y], v[t.z])) + 2.0 * distance_};
        for (const std::uint32_t other : tree.meeting(box)) near.insert(tree.source(other));
      }
      for (const std::uint32_t t : near) near_[f].push_back(mesh.triangles[t]);
    }
  }

  // Returns the number of pairs of faces that cross where vertices moved, and adds the places.
  std::size_t crossings(const Progress* progress, std::set<int>* places = nullptr) const {
    std::size_t count = 0;
    for (std::uint32_t f = 0; f < meshes_.size(); ++f) {
      if (near_[f].empty()) continue;
      std::vector<std::uint32_t> used;
      for (const glm::uvec3& t : near_[f]) used.insert(used.end(), {t.x, t.y, t.z});
      const VertexNumbers numbers(std::move(used), meshes_[f].mesh.vertices.size());
      TriangleMesh local;
      for (const std::uint32_t v : numbers.vertices()) {
        local.vertices.push_back(meshes_[f].mesh.vertices[v]);
      }
      for (const glm::uvec3& t : near_[f]) {
        local.triangles.emplace_back(numbers.of(t.x), numbers.of(t.y), numbers.of(t.z));
      }
      const TriangleMesh one = merged(local);
      const std::vector<std::uint8_t> isMoved = movedOf(f, near_[f]);
      const auto pairs = selfCrossings(one.vertices, one.triangles, progress, {.of = isMoved});
      count += pairs.size();
      for (std::size_t i = 0; i < pairs.size() && places != nullptr; ++i) {
        for (const std::uint32_t t : pairs[i]) addPlaces(f, near_[f][t], *places);
      }
    }
    return count;
  }

  void addPlaces(std::uint32_t f, const glm::uvec3& triangle, std::set<int>& places) const {
    for (int k = 0; k < 3; ++k) {
      const auto node = number_.find({f, triangle[k]});
      if (node == number_.end()) continue;
      if (const int place = placeOf_[sheetOf_[node->second]]; place >= 0) places.insert(place);
    }
  }

  // Tries all ways of a place, and keeps the first of the best.  Returns how many faces cross.
  std::size_t improve(Place& place, std::size_t count, const Progress* progress) {
    Place best = place;
    std::vector<int> bestWays = ways_;
    const std::vector<int> before = ways_;
    for (place.stays = 0; place.stays < place.sheets.size(); ++place.stays) {
      for (std::size_t i = 0; i < place.sheets.size(); ++i) {
        if (i == place.stays) continue;
        ways_ = before;
        const int last = isAtEdge_[place.sheets[i]] ? kMostWays - 1 : kStays;
        for (int& way = ways_[place.sheets[i]] = 0; way <= last && count > 0; ++way) {
          move(place);
          const std::size_t now = crossings(progress);
          if (now >= count) continue;
          count = now;
          best = place;
          bestWays = ways_;
        }
      }
    }
    place = std::move(best);
    ways_ = std::move(bestWays);
    move(place);
    return count;
  }

  // Finds sheets: vertices are of one where both sides of a crack have them.
  void connect(const std::set<TouchingEdge>& edges) {
    UnionFind sheets(nodes_.size());
    // A face by its positions: a corner's node of the side that has it first.
    std::map<std::array<Position, 3>, std::array<std::uint32_t, 3>> faces;
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    corners_.assign(nodes_.size(), 0);
    inwards_.assign(nodes_.size(), glm::dvec3(0.0));
    around_.assign(nodes_.size(), glm::dvec3(0.0));
    isAtEdge_.assign(nodes_.size(), false);
    ways_.assign(nodes_.size(), 0);
    placeOf_.assign(nodes_.size(), -1);
    shortest_.assign(nodes_.size(), std::numeric_limits<double>::infinity());
    for (std::uint32_t f = 0; f < meshes_.size(); ++f) {
      const LabeledMesh& own = meshes_[f];
      for (std::size_t t = 0; t < own.mesh.triangles.size(); ++t) {
        std::array<std::pair<Position, std::uint32_t>, 3> corners;
        bool isAny = false;
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t v = own.mesh.triangles[t][k];
          const auto found = number_.find({f, v});
          const bool isNode = found != number_.end();
          isAny |= isNode;
          corners[static_cast<std::size_t>(k)] = {pointOf(own.mesh.vertices[v]),
                                                  isNode ? found->second : kNone};
        }
        if (!isAny) continue;
        measure(own, t, {corners[0].second, corners[1].second, corners[2].second});
        for (std::size_t k = 0; k < 3; ++k) {
          const auto& [from, a] = corners[k];
          const auto& [to, b] = corners[(k + 1) % 3];
          if (a == kNone || b == kNone || !edges.contains(TouchingEdge(f, from, to))) continue;
          isAtEdge_[a] = isAtEdge_[b] = true;
        }
        if (own.other[t] == 0) continue;
        std::sort(corners.begin(), corners.end());
        const std::array<Position, 3> key{corners[0].first, corners[1].first, corners[2].first};
        const std::array<std::uint32_t, 3> nodes{corners[0].second, corners[1].second,
                                                 corners[2].second};
        const auto [other, isNew] = faces.try_emplace(key, nodes);
        for (std::size_t k = 0; !isNew && k < 3; ++k) {
          if (nodes[k] != kNone && other->second[k] != kNone) {
            sheets.unite(nodes[k], other->second[k]);
          }
        }
      }
    }
    sheetOf_ = std::move(sheets).all();
    for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
      const std::uint32_t name = sheetOf_[n];
      if (name == n) continue;
      corners_[name] += corners_[n];
      inwards_[name] += inwards_[n];
      around_[name] += around_[n];
      isAtEdge_[name] = isAtEdge_[name] || isAtEdge_[n];
      shortest_[name] = std::min(shortest_[name], shortest_[n]);
    }
  }

  // Adds a triangle to what is known of its corners.
  void measure(const LabeledMesh& own, std::size_t t, const std::array<std::uint32_t, 3>& nodes) {
    const glm::uvec3& c = own.mesh.triangles[t];
    const std::vector<glm::dvec3>& v = own.mesh.vertices;
    const glm::dvec3 across = glm::cross(v[c.y] - v[c.x], v[c.z] - v[c.x]);
    const double twice = glm::length(across);
    for (std::size_t k = 0; k < 3; ++k) {
      if (nodes[k] >= nodes_.size()) continue;
      const auto corner = [&](std::size_t i) { return v[c[static_cast<int>(i % 3)]]; };
      const glm::dvec3 a = corner(k + 1) - corner(k), b = corner(k + 2) - corner(k);
      const double height = twice / std::max(glm::length(b - a), 1e-300);
      shortest_[nodes[k]] = std::min({shortest_[nodes[k]], glm::length(a), glm::length(b),
                                      height > 0.0 ? height : shortest_[nodes[k]]});
      ++corners_[nodes[k]];
      around_[nodes[k]] += a + b;
      if (own.other[t] != 0 || !(twice > 0.0)) continue;
      const double angle = std::atan2(twice, glm::dot(a, b));
      inwards_[nodes[k]] -= across * (angle / twice);
    }
  }

  // Returns how a sheet moves.
  [[nodiscard]] glm::dvec3 wayOf(std::uint32_t sheet) const {
    if (ways_[sheet] == kStays) return glm::dvec3(0.0);
    const auto way = static_cast<Way>(ways_[sheet] % kWays);
    const double share = std::ldexp(1.0, -2 * (ways_[sheet] / kWays));
    const double sign = way == Way::inwards || way == Way::together ? 1.0 : -1.0;
    const bool isNormal = way == Way::inwards || way == Way::outwards;
    const glm::dvec3 mean = around_[sheet] / std::max(2.0 * corners_[sheet], 1.0);
    const glm::dvec3& along = isNormal ? inwards_[sheet] : mean;
    const double length = glm::length(along);
    if (!(length > 0.0)) return glm::dvec3(0.0);
    const double most = kOfShortest * (isNormal ? shortest_[sheet] : length);
    return along * (sign * share * std::min(distance_, most) / length);
  }

  void move(const Place& place) {
    for (std::size_t i = 0; i < place.sheets.size(); ++i) {
      const glm::dvec3 by = i == place.stays ? glm::dvec3(0.0) : wayOf(place.sheets[i]);
      for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
        if (sheetOf_[n] != place.sheets[i]) continue;
        const auto& [fragment, vertex, at] = nodes_[n];
        meshes_[fragment].mesh.vertices[vertex] = at + by;
        if (by == glm::dvec3(0.0)) {
          moved_.erase({fragment, vertex});
        } else {
          moved_.insert({fragment, vertex});
        }
      }
    }
  }

  std::vector<LabeledMesh>& meshes_;
  std::vector<Node> nodes_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> number_;  // of nodes
  std::vector<std::uint32_t> sheetOf_, corners_;  // [nodes]; the second of sheets
  std::vector<glm::dvec3> inwards_;               // of sheets, weighted by angles
  std::vector<glm::dvec3> around_;                // of sheets, sum of the ways to other corners
  std::vector<double> shortest_;                  // of sheets
  std::vector<bool> isAtEdge_;                    // of sheets
  std::vector<int> ways_;                         // of sheets, see Way
  std::vector<int> placeOf_;                      // of sheets, -1: none
  std::vector<Place> places_;
  std::vector<std::vector<glm::uvec3>> near_;  // [meshes] the triangles that moved ones may cross
  double distance_ = 0.0;
  std::set<std::pair<std::uint32_t, std::uint32_t>> moved_;
};

double longestSideOf(const std::vector<LabeledMesh>& meshes) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const LabeledMesh& mesh : meshes) {
    for (const glm::dvec3& v : mesh.mesh.vertices) {
      low = glm::min(low, v);
      high = glm::max(high, v);
    }
  }
  const glm::dvec3 size = high - low;
  return std::max({size.x, size.y, size.z});
}

}  // namespace

std::size_t touchingEdges(const LabeledMesh& mesh) {
  std::size_t count = 0;
  forEachTouching(mesh, [&](const EdgeUse&) { ++count; });
  return count;
}

std::string partSheets(std::vector<LabeledMesh>& meshes, const Progress* progress) {
  std::set<TouchingEdge> edges;
  for (std::uint32_t f = 0; f < meshes.size(); ++f) {
    const std::vector<glm::dvec3>& vertices = meshes[f].mesh.vertices;
    forEachTouching(meshes[f], [&](const EdgeUse& edge) {
      edges.emplace(f, pointOf(vertices[edge.low]), pointOf(vertices[edge.high]));
    });
  }
  if (edges.empty()) return {};
  const double distance = kPartedSheets * longestSideOf(meshes);
  Touching touching(meshes, edges);
  touching.part(distance);
  bool isCrossed = touching.isCrossed(progress);
  for (int way = kWays; way < kMostWays && isCrossed; way += kWays) {
    touching.moveBy(way);
    isCrossed = touching.isCrossed(progress);
  }
  if (isCrossed) {
    touching.search(progress);
    isCrossed = touching.isCrossed(progress);
  }
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (touchingEdges(meshes[i]) == 0) continue;
    return "fragment " + std::to_string(i + 1) +
           " of the united bodies touches itself along an edge";
  }
  return isCrossed ? "parts of the united bodies cannot be parted" : std::string();
}

}  // namespace sherd
