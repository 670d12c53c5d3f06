// Sheets that a mesh has from both sides, as leaves and cards have.
#include "mesh/repair/sheets.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

#include "base/cancel_flag.h"
#include "mesh/search/triangle_tree.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

// A polygon of 18 corners has as many triangles on its two sides.
constexpr std::size_t kFewTriangles = 32;

// Distances from the plane, relative to an edge and to the mesh's box: single precision's rounding.
constexpr double kFlatOfEdge = 1e-5, kFlatOfBox = 1e-6;

// Of the area of one side of all sheets, relative to the rest's: leaves are more of a tree.
constexpr double kFewArea = 0.005;

glm::dvec3 centroidOf(const std::array<glm::dvec3, 3>& t) { return (t[0] + t[1] + t[2]) / 3.0; }

// The half edges of some triangles, by edge.
struct HalfEdges {
  struct Half {
    std::uint64_t edge;
    std::uint32_t at;  // index of the triangle among them
    bool isForward;
  };
  std::vector<Half> all;                            // sorted by edge
  std::vector<std::array<std::uint32_t, 3>> first;  // [triangles] of the edge's half edges

  HalfEdges(const TriangleMesh& mesh, std::span<const std::uint32_t> among) : first(among.size()) {
    all.reserve(3 * among.size());
    for (std::uint32_t i = 0; i < among.size(); ++i) {
      const glm::uvec3& t = mesh.triangles[among[i]];
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t from = t[k], to = t[(k + 1) % 3];
        all.push_back({std::uint64_t{std::min(from, to)} << 32 | std::max(from, to), i, from < to});
      }
    }
    std::sort(all.begin(), all.end(), [](const Half& a, const Half& b) {
      return a.edge != b.edge ? a.edge < b.edge : a.at < b.at;
    });
    std::vector<std::uint8_t> next(among.size(), 0);
    std::uint32_t begin = 0;
    for (std::uint32_t i = 0; i < all.size(); ++i) {
      if (all[i].edge != all[begin].edge) begin = i;
      first[all[i].at][next[all[i].at]++] = begin;
    }
  }

  // Calls visit(Half) for the half edges of the edges of a triangle.
  template <class Visit>
  void forEachAround(std::uint32_t at, Visit visit) const {
    for (const std::uint32_t begin : first[at]) {
      for (std::size_t i = begin; i < all.size() && all[i].edge == all[begin].edge; ++i) {
        visit(all[i]);
      }
    }
  }
};

// Finds the triangles in the plane of each one.
class Flats {
 public:
  Flats(const TriangleMesh& mesh, std::span<const std::uint32_t> among)
      : mesh_(mesh),
        among_(among),
        edges_(mesh, among),
        slack_(kFlatOfBox * longestSide(bounds(mesh))),
        groupOf_(among.size(), kNone) {}

  FlatSheets sheets() {
    FlatSheets out;
    for (std::uint32_t start = 0; start < among_.size(); ++start) {
      if (groupOf_[start] != kNone) continue;
      grow(start);
      if (group_.size() > 1 && isSheet(start)) add(out);
    }
    std::sort(out.triangles.begin(), out.triangles.end());
    return out;
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  [[nodiscard]] std::array<glm::dvec3, 3> corners(std::uint32_t at) const {
    return positionsOf(mesh_.vertices, mesh_.triangles[among_[at]]);
  }

  // Sets the group of triangles in the plane of one, connected to it.
  void grow(std::uint32_t start) {
    const std::array<glm::dvec3, 3> t = corners(start);
    const glm::dvec3 across = areaNormal(t);
    const double length = glm::length(across);
    start_ = start;
    group_.assign(1, start);
    groupOf_[start] = start;
    if (!(length > 0.0)) return;
    normal_ = across / length;
    const double reach =
        slack_ + kFlatOfEdge * std::max({glm::length(t[1] - t[0]), glm::length(t[2] - t[1]),
                                         glm::length(t[0] - t[2])});
    for (std::size_t i = 0; i < group_.size(); ++i) {
      edges_.forEachAround(group_[i], [&](const HalfEdges::Half& half) {
        if (groupOf_[half.at] != kNone) return;
        const auto isNear = [&](const glm::dvec3& p) {
          return std::abs(glm::dot(p - t[0], normal_)) <= reach;
        };
        const std::array<glm::dvec3, 3> other = corners(half.at);
        if (!std::all_of(other.begin(), other.end(), isNear)) return;
        groupOf_[half.at] = start;
        group_.push_back(half.at);
      });
    }
  }

  // Whether the group has each of its edges as often in one direction as in the other, and some
  // edge alone: bodies that touch have faces between them whose edges are theirs too.
  [[nodiscard]] bool isSheet(std::uint32_t group) const {
    bool hasOwn = false;
    for (const std::uint32_t at : group_) {
      for (const std::uint32_t begin : edges_.first[at]) {
        int balance = 0, own = 0, all = 0;
        for (std::size_t i = begin;
             i < edges_.all.size() && edges_.all[i].edge == edges_.all[begin].edge; ++i) {
          ++all;
          if (groupOf_[edges_.all[i].at] != group) continue;
          ++own;
          balance += edges_.all[i].isForward ? 1 : -1;
        }
        if (balance != 0) return false;
        hasOwn = hasOwn || (own == 2 && all == 2 && isFold(begin));
      }
    }
    return hasOwn;
  }

  // Whether the two triangles at an edge lie on each other.
  [[nodiscard]] bool isFold(std::size_t begin) const {
    return glm::dot(areaNormal(corners(edges_.all[begin].at)),
                    areaNormal(corners(edges_.all[begin + 1].at))) < 0.0;
  }

  void add(FlatSheets& out) const {
    TriangleMesh behind;  // its faces, with vertices of their own
    std::vector<std::uint32_t> backs;
    std::map<std::array<std::uint32_t, 3>, std::uint32_t> fronts;  // each once
    for (const std::uint32_t at : group_) {
      const std::uint32_t triangle = among_[at];
      out.triangles.push_back(triangle);
      const std::array<glm::dvec3, 3> t = corners(at);
      if (glm::dot(areaNormal(t), normal_) > 0.0) {
        const glm::uvec3& c = mesh_.triangles[triangle];
        std::array<std::uint32_t, 3> key{c.x, c.y, c.z};
        std::sort(key.begin(), key.end());
        fronts.try_emplace(key, at);
      } else {
        const auto first = static_cast<std::uint32_t>(behind.vertices.size());
        behind.vertices.insert(behind.vertices.end(), t.begin(), t.end());
        behind.triangles.emplace_back(first, first + 1, first + 2);
        backs.push_back(triangle);
      }
    }
    const std::uint32_t group = fronts.size() == backs.size() ? start_ + 1 : 0;
    const TriangleTree tree(behind);
    std::size_t next = 0;
    for (const auto& [key, at] : fronts) {
      const std::uint32_t nearest =
          tree.nearest(centroidOf(corners(at)), std::numeric_limits<double>::infinity()).triangle;
      if (nearest == TriangleTree::kNone) continue;
      out.faces.push_back({.corners = mesh_.triangles[among_[at]],
                           .front = among_[at],
                           .back = backs[tree.source(nearest)],
                           .group = group,
                           .groupSize = static_cast<std::uint32_t>(fronts.size()),
                           .other = group == 0 ? 0 : backs[next++]});
    }
  }

  const TriangleMesh& mesh_;
  const std::span<const std::uint32_t> among_;
  const HalfEdges edges_;
  const double slack_;
  std::vector<std::uint32_t> groupOf_;  // [among] its first triangle
  std::vector<std::uint32_t> group_;
  std::uint32_t start_ = 0;  // the group's first triangle
  glm::dvec3 normal_{0.0};
};

}  // namespace

FlatSheets flatSheets(const TriangleMesh& mesh, std::span<const std::uint32_t> among) {
  return among.empty() ? FlatSheets{} : Flats(mesh, among).sheets();
}

std::vector<std::uint32_t> ofSmallComponents(const MeshComponents& components) {
  std::vector<std::size_t> sizes(components.count, 0);
  for (const std::uint32_t component : components.ofTriangle) ++sizes[component];
  std::vector<std::uint32_t> out;
  for (std::uint32_t t = 0; t < components.ofTriangle.size(); ++t) {
    if (sizes[components.ofTriangle[t]] <= kFewTriangles) out.push_back(t);
  }
  return out;
}

void keepOutside(std::vector<SheetFace>& faces, const TriangleMesh& rest,
                 const Progress* progress) {
  if (faces.empty() || rest.triangles.empty()) return;
  const TriangleTree tree(rest);
  std::vector<std::uint8_t> isInside(faces.size(), 0);
  CancelFlag cancelled(progress);
  tbb::parallel_for(std::size_t{0}, faces.size(), [&](std::size_t i) {
    if (cancelled.isSet()) return;
    const double winding = tree.winding(centroidOf(positionsOf(rest.vertices, faces[i].corners)));
    // The direction that the hole of a closed mesh lets through is half of all.
    isInside[i] = winding >= (faces[i].isBetweenOthers ? 0.25 : 0.6) ? 1 : 0;
  });
  cancelled.throwIfSet();
  std::size_t i = 0;
  std::erase_if(faces, [&](const SheetFace&) { return isInside[i++] != 0; });
}

bool areFew(std::span<const SheetFace> faces, const TriangleMesh& rest) {
  double ofSheets = 0.0, ofRest = 0.0;
  for (const SheetFace& face : faces) {
    ofSheets += 0.5 * glm::length(areaNormal(positionsOf(rest.vertices, face.corners)));
  }
  for (const glm::uvec3& t : rest.triangles) {
    ofRest += 0.5 * glm::length(areaNormal(positionsOf(rest.vertices, t)));
  }
  return ofSheets <= kFewArea * ofRest;
}

}  // namespace sherd
