// Triangles that fill loops of edges.
#include "remesh/parts/fill_loops.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>

#include "base/cancel_flag.h"
#include "intersect/crossing_point.h"
#include "intersect/triangulate.h"
#include "mesh/largest_axis.h"
#include "mesh/search/boxes.h"

namespace sherd {
namespace {

using Index = std::uint32_t;
using Loop = std::vector<Index>;
using Edge = std::pair<Index, Index>;

// How far vertices of a planar loop may be from its plane, and those of other loops in that plane,
// in longest sides of its box.
constexpr double kPlanar = 1.0 / 32, kOnePlane = 1e-4;

// As often may planar loops wind around a point: each is a layer of triangles.
constexpr int kMostLayers = 8;

// The plane of a loop.
struct LoopPlane {
  Box box{};
  glm::dvec3 middle{0.0};
  glm::dvec3 area{0.0};  // of the loop, as a vector
  double size = 0.0;     // longest side of the box
  bool isPlanar = false;

  [[nodiscard]] double heightOf(const glm::dvec3& p) const {
    return std::abs(glm::dot(p - middle, glm::normalize(area)));
  }
};

LoopPlane planeOf(std::span<const glm::dvec3> vertices, const Loop& loop) {
  LoopPlane plane{.box = {vertices[loop[0]], vertices[loop[0]]}};
  for (const Index v : loop) {
    plane.box = {glm::min(plane.box.min, vertices[v]), glm::max(plane.box.max, vertices[v])};
    plane.middle += vertices[v] / static_cast<double>(loop.size());
  }
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const glm::dvec3& next = vertices[loop[(i + 1) % loop.size()]];
    plane.area += 0.5 * glm::cross(vertices[loop[i]] - plane.middle, next - plane.middle);
  }
  plane.size = longestSide(plane.box);
  constexpr double kThin = 1e-6;  // of a loop that encloses no area
  if (glm::length(plane.area) <= kThin * plane.size * plane.size) return plane;
  plane.isPlanar = std::all_of(loop.begin(), loop.end(), [&](Index v) {
    return plane.heightOf(vertices[v]) <= kPlanar * plane.size;
  });
  return plane;
}

// Loops, seen along an axis: a triangulation whose triangles have winding numbers.
class FlatLoops {
 public:
  FlatLoops(std::span<const glm::dvec3> vertices, std::span<const Loop* const> loops, int axis)
      : vertices_(vertices), axis_(axis) {
    addFrame(loops);
    for (const Loop* loop : loops) {
      for (std::size_t i = 0; i < loop->size(); ++i) {
        addUse(localOf((*loop)[i]), localOf((*loop)[(i + 1) % loop->size()]));
      }
    }
  }

  // Appends the triangles that the loops wind around.  Returns false if the loops cross, or wind
  // too often.
  bool fill(std::vector<glm::uvec3>& out) {
    std::vector<std::array<Index, 2>> segments;
    for (const auto& [edge, uses] : uses_) segments.push_back({edge.first, edge.second});
    const Triangulation parts = triangulate(points_, segments);
    if (!parts.isComplete()) return false;
    std::vector<int> winding;
    if (!windingOf(parts.triangles, winding)) return false;
    for (std::size_t t = 0; t < winding.size(); ++t) {
      const glm::uvec3& c = parts.triangles[t];
      if (std::abs(winding[t]) > kMostLayers) return false;
      if (winding[t] != 0 && (c.x < 3 || c.y < 3 || c.z < 3)) return false;
    }
    for (std::size_t t = 0; t < winding.size(); ++t) {
      const glm::uvec3& c = parts.triangles[t];
      for (int i = 0; i < std::abs(winding[t]); ++i) {
        const glm::uvec3 own(numbers_[c.x], numbers_[c.y], numbers_[c.z]);
        out.push_back(winding[t] > 0 ? own : glm::uvec3(own.x, own.z, own.y));
      }
    }
    return true;
  }

 private:
  // A triangle around all loops, counter-clockwise as seen along the axis.
  void addFrame(std::span<const Loop* const> loops) {
    glm::dvec3 low = vertices_[loops[0]->front()], high = low;
    for (const Loop* loop : loops) {
      for (const Index v : *loop) {
        low = glm::min(low, vertices_[v]);
        high = glm::max(high, vertices_[v]);
      }
    }
    const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
    const double reach = 4.0 * std::max(high[u] - low[u], high[v] - low[v]);
    for (const auto& [x, y] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {0.0, 1.0}}) {
      glm::dvec3 corner = (low + high) / 2.0;
      corner[u] += x * reach;
      corner[v] += y * reach;
      points_.push_back({ExactPoint(corner), kCornerEdges[points_.size()]});
      numbers_.push_back(0);
    }
  }

  Index localOf(Index vertex) {
    const auto [found, isNew] = locals_.try_emplace(vertex, static_cast<Index>(points_.size()));
    if (isNew) {
      points_.push_back({ExactPoint(vertices_[vertex])});
      numbers_.push_back(vertex);
    }
    return found->second;
  }

  void addUse(Index from, Index to) { uses_[std::minmax(from, to)] += from < to ? 1 : -1; }

  // Loops that use an edge in this direction, minus those that use it in the other.
  [[nodiscard]] int usesOf(Index from, Index to) const {
    const auto found = uses_.find(std::minmax(from, to));
    if (found == uses_.end()) return 0;
    return from < to ? found->second : -found->second;
  }

  // Finds the winding numbers, from the frame inwards: to the left of a loop it is one more than to
  // the right.  Returns false if they contradict each other, which has no known cause.
  bool windingOf(const std::vector<glm::uvec3>& triangles, std::vector<int>& winding) const {
    constexpr int kUnknown = std::numeric_limits<int>::max();
    std::map<Edge, Index> left;  // of a directed edge, the triangle there
    for (Index t = 0; t < triangles.size(); ++t) {
      for (int k = 0; k < 3; ++k) left[{triangles[t][k], triangles[t][(k + 1) % 3]}] = t;
    }
    winding.assign(triangles.size(), kUnknown);
    std::vector<Index> found;
    for (Index t = 0; t < triangles.size() && found.empty(); ++t) {
      const glm::uvec3& c = triangles[t];
      if (c.x < 3 || c.y < 3 || c.z < 3) found.push_back(t);
    }
    if (found.empty()) return false;
    winding[found[0]] = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const glm::uvec3& c = triangles[found[i]];
      for (int k = 0; k < 3; ++k) {
        const Index from = c[k], to = c[(k + 1) % 3];
        const auto beside = left.find({to, from});
        if (beside == left.end()) continue;  // the frame's own edge
        const int expected = winding[found[i]] - usesOf(from, to);
        int& known = winding[beside->second];
        if (known == kUnknown) {
          known = expected;
          found.push_back(beside->second);
        }
        if (known != expected) return false;
      }
    }
    return found.size() == triangles.size();
  }

  std::span<const glm::dvec3> vertices_;
  const int axis_;
  std::vector<TrianglePoint> points_;  // the frame, then the loops'
  std::vector<Index> numbers_;         // [points_]
  std::unordered_map<Index, Index> locals_;
  std::map<Edge, int> uses_;  // by points_, lower first: from the lower minus from the higher one
};

// The triangulation of one loop that has the least area.
class LeastArea {
 public:
  LeastArea(std::span<const glm::dvec3> vertices, const Loop& loop, const KnownEdges& edges)
      : loop_(loop), count_(loop.size()), best_(count_ * count_), middle_(count_ * count_) {
    double size = 0.0;
    for (const Index v : loop) {
      at_.push_back(vertices[v]);
      size = std::max(size, glm::distance(vertices[v], at_[0]));
    }
    for (std::size_t width = 2; width < count_; ++width) {
      for (std::size_t i = 0; i + width < count_; ++i) findBest(i, i + width, size, edges);
    }
  }

  void appendTriangles(std::vector<glm::uvec3>& out) const {
    std::vector<std::pair<std::size_t, std::size_t>> rest{{0, count_ - 1}};
    while (!rest.empty()) {
      const auto [i, j] = rest.back();
      rest.pop_back();
      if (j < i + 2) continue;
      const std::size_t m = middle_[i * count_ + j];
      out.emplace_back(loop_[i], loop_[m], loop_[j]);
      rest.insert(rest.end(), {{i, m}, {m, j}});
    }
  }

 private:
  // Triangulates the loop's section from i to j.  A triangle without area, and an edge that the
  // mesh has already, cost more than any area.
  void findBest(std::size_t i, std::size_t j, double size, const KnownEdges& edges) {
    constexpr double kFlat = 1e-9;
    const double penalty = 10.0 * size * size;
    const bool isInner = j - i + 1 < count_;
    const Edge chord = std::minmax(loop_[i], loop_[j]);
    const double own =
        isInner && std::binary_search(edges.begin(), edges.end(), chord) ? penalty : 0.0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t m = i + 1; m < j; ++m) {
      const double area = 0.5 * glm::length(glm::cross(at_[m] - at_[i], at_[j] - at_[i]));
      const double cost = best_[i * count_ + m] + best_[m * count_ + j] + area +
                          (area <= kFlat * size * size ? penalty : 0.0);
      if (cost >= least) continue;
      least = cost;
      middle_[i * count_ + j] = static_cast<Index>(m);
    }
    best_[i * count_ + j] = least + own;
  }

  const Loop& loop_;
  const std::size_t count_;
  std::vector<glm::dvec3> at_;
  std::vector<double> best_;   // [from * count + to] of a section
  std::vector<Index> middle_;  // of the triangle at its chord
};

class Filling {
 public:
  Filling(std::span<const glm::dvec3> vertices, std::span<const Loop> loops,
          const KnownEdges& edges)
      : vertices_(vertices), loops_(loops), edges_(edges), isFilled_(loops.size(), false) {
    for (const Loop& loop : loops) planes_.push_back(planeOf(vertices, loop));
  }

  FilledLoops fill(const Progress* progress) && {
    std::vector<std::size_t> order(loops_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return planes_[a].size > planes_[b].size;
    });
    for (const std::size_t i : order) {
      throwIfCancelled(progress);
      if (isFilled_[i]) continue;
      if (loops_[i].size() > 3 && planes_[i].isPlanar && fillPlane(i, order)) continue;
      fillAlone(i);
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] bool areInOnePlane(std::size_t i, std::size_t other) const {
    if (!planes_[other].isPlanar || !meet(planes_[i].box, planes_[other].box)) return false;
    return std::all_of(loops_[other].begin(), loops_[other].end(), [&](Index v) {
      return planes_[i].heightOf(vertices_[v]) <= kOnePlane * planes_[i].size;
    });
  }

  bool fillLoops(std::span<const Loop* const> loops, std::size_t i) {
    return FlatLoops(vertices_, loops, largestAxis(planes_[i].area)).fill(out_.triangles);
  }

  // Fills a planar loop with those in its plane that are beside or within it.
  bool fillPlane(std::size_t i, std::span<const std::size_t> order) {
    std::vector<const Loop*> together;
    std::vector<std::size_t> own;
    for (const std::size_t other : order) {
      if (isFilled_[other] || (other != i && !areInOnePlane(i, other))) continue;
      together.push_back(&loops_[other]);
      own.push_back(other);
    }
    if (together.size() > 1 && fillLoops(together, i)) {
      for (const std::size_t one : own) isFilled_[one] = true;
      return true;
    }
    const Loop* const alone = &loops_[i];
    return fillLoops(std::span(&alone, 1), i);
  }

  void fillAlone(std::size_t i) {
    const Loop& loop = loops_[i];
    if (loop.size() <= kMostForLeastArea) {
      LeastArea(vertices_, loop, edges_).appendTriangles(out_.triangles);
      return;
    }
    const Loop* const alone = &loop;
    if (fillLoops(std::span(&alone, 1), i)) return;
    const auto center = static_cast<Index>(vertices_.size() + out_.centers.size());
    out_.centers.push_back(planes_[i].middle);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      out_.triangles.emplace_back(loop[k], loop[(k + 1) % loop.size()], center);
    }
  }

  std::span<const glm::dvec3> vertices_;
  std::span<const Loop> loops_;
  const KnownEdges& edges_;
  std::vector<LoopPlane> planes_;
  std::vector<bool> isFilled_;
  FilledLoops out_;
};

}  // namespace

FilledLoops filledLoops(std::span<const glm::dvec3> vertices,
                        std::span<const std::vector<std::uint32_t>> loops, const KnownEdges& edges,
                        const Progress* progress) {
  return Filling(vertices, loops, edges).fill(progress);
}

}  // namespace sherd
