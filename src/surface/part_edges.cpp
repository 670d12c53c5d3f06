// Fragments that touch themselves along edges, parted there.
#include "surface/part_edges.h"

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
#include "exact/self_crossings.h"
#include "mesh/edges.h"
#include "mesh/positions.h"

namespace sherd {
namespace {

// Vertices move by at most this share of the shortest edge or height there.
constexpr double kOfShortest = 0.25;

// How often a sheet that would cross others is moved by a part of the way.
constexpr int kMostTries = 4;

using Point = std::array<double, 3>;

Point pointOf(const glm::dvec3& p) { return {p.x, p.y, p.z}; }

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
  Touching(std::vector<LabeledMesh>& meshes, const std::set<Point>& positions) : meshes_(meshes) {
    for (std::uint32_t f = 0; f < meshes.size(); ++f) addNodes(f, positions);
    connect();
  }

  // Moves all sheets but one at each position.
  //   share  of the way
  void part(double distance, double share) {
    std::map<Point, std::vector<std::uint32_t>> sheets;  // names of sheets, by position
    for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
      std::vector<std::uint32_t>& own = sheets[pointOf(nodes_[n].at)];
      if (const std::uint32_t name = sheetOf_[n]; std::ranges::find(own, name) == own.end()) {
        own.push_back(name);
      }
    }
    for (auto& [at, names] : sheets) {
      // That with the most triangles stays.
      std::ranges::stable_sort(
          names, [&](std::uint32_t a, std::uint32_t b) { return corners_[a] > corners_[b]; });
      for (std::size_t i = 1; i < names.size(); ++i) move(names[i], distance * share);
    }
  }

  // Whether faces at moved vertices cross others of their fragment.
  [[nodiscard]] bool isCrossed(const Progress* progress) const {
    for (std::uint32_t f = 0; f < meshes_.size(); ++f) {
      const TriangleMesh& mesh = meshes_[f].mesh;
      std::vector<std::uint8_t> isMoved(mesh.triangles.size(), 0);
      bool isAny = false;
      for (std::size_t t = 0; t < isMoved.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
          if (!moved_.contains({f, mesh.triangles[t][k]})) continue;
          isMoved[t] = 1;
          isAny = true;
        }
      }
      if (!isAny) continue;
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

  void addNodes(std::uint32_t f, const std::set<Point>& positions) {
    const std::vector<glm::dvec3>& vertices = meshes_[f].mesh.vertices;
    for (std::uint32_t v = 0; v < vertices.size(); ++v) {
      if (!positions.contains(pointOf(vertices[v]))) continue;
      number_[{f, v}] = static_cast<std::uint32_t>(nodes_.size());
      nodes_.push_back({f, v, vertices[v]});
    }
  }

  // Finds sheets: vertices are of one where both sides of a crack have them.
  void connect() {
    UnionFind sheets(nodes_.size());
    // A face by its positions: a corner's node of the side that has it first.
    std::map<std::array<Point, 3>, std::array<std::uint32_t, 3>> faces;
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    corners_.assign(nodes_.size(), 0);
    inwards_.assign(nodes_.size(), glm::dvec3(0.0));
    shortest_.assign(nodes_.size(), std::numeric_limits<double>::infinity());
    for (std::uint32_t f = 0; f < meshes_.size(); ++f) {
      const LabeledMesh& own = meshes_[f];
      for (std::size_t t = 0; t < own.mesh.triangles.size(); ++t) {
        std::array<std::pair<Point, std::uint32_t>, 3> corners;
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
        if (own.other[t] == 0) continue;
        std::sort(corners.begin(), corners.end());
        const std::array<Point, 3> key{corners[0].first, corners[1].first, corners[2].first};
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
      if (own.other[t] != 0 || !(twice > 0.0)) continue;
      const double angle = std::atan2(twice, glm::dot(a, b));
      inwards_[nodes[k]] -= across * (angle / twice);
    }
  }

  void move(std::uint32_t sheet, double distance) {
    const double length = glm::length(inwards_[sheet]);
    if (!(length > 0.0)) return;
    const glm::dvec3 by =
        inwards_[sheet] * (std::min(distance, kOfShortest * shortest_[sheet]) / length);
    for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
      if (sheetOf_[n] != sheet) continue;
      meshes_[nodes_[n].fragment].mesh.vertices[nodes_[n].vertex] = nodes_[n].at + by;
      moved_.insert({nodes_[n].fragment, nodes_[n].vertex});
    }
  }

  std::vector<LabeledMesh>& meshes_;
  std::vector<Node> nodes_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> number_;  // of nodes
  std::vector<std::uint32_t> sheetOf_, corners_;  // [nodes]; the second of sheets
  std::vector<glm::dvec3> inwards_;               // of sheets, weighted by angles
  std::vector<double> shortest_;                  // of sheets
  std::set<std::pair<std::uint32_t, std::uint32_t>> moved_;
};

double longestSide(const std::vector<LabeledMesh>& meshes) {
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
  std::set<Point> positions;
  for (const LabeledMesh& labeled : meshes) {
    const std::vector<glm::dvec3>& vertices = labeled.mesh.vertices;
    forEachTouching(labeled, [&](const EdgeUse& edge) {
      positions.insert(pointOf(vertices[edge.low]));
      positions.insert(pointOf(vertices[edge.high]));
    });
  }
  if (positions.empty()) return {};
  const double distance = kPartedSheets * longestSide(meshes);
  Touching touching(meshes, positions);
  double share = 1.0;
  for (int attempt = 0; attempt < kMostTries; ++attempt, share /= 4.0) {
    throwIfCancelled(progress);
    touching.part(distance, share);
    if (!touching.isCrossed(progress)) break;
  }
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (touchingEdges(meshes[i]) == 0) continue;
    return "fragment " + std::to_string(i + 1) +
           " of the united bodies touches itself along an edge";
  }
  if (touching.isCrossed(progress)) return "parts of the united bodies cannot be parted";
  return {};
}

}  // namespace sherd
