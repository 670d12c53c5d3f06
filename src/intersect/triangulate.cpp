// The constrained triangulation of one triangle.
#include "intersect/triangulate.h"

#include <algorithm>
#include <cassert>
#include <deque>
#include <utility>

#include "base/cancel_flag.h"
#include "base/random.h"
#include "intersect/half_edges.h"
#include "intersect/triangle_plane.h"

namespace sherd {
namespace {

using Index = HalfEdges::Index;

class Triangulator {
 public:
  Triangulator(std::span<const TrianglePoint> points, const TrianglePlane& plane)
      : plane_(plane), mesh_(points.size()), coincides_(points.size(), false) {}

  void addPoints(const Progress* progress);
  void addSegment(Index segment, Index from, Index to);
  void improve();
  [[nodiscard]] Triangulation result();

 private:
  // Where a point lies.
  struct Location {
    enum class Kind { inside, onEdge, atVertex } kind;
    Index halfEdge;  // of the triangle, the edge, or from the vertex
  };
  [[nodiscard]] Location locate(Index point);
  void addPoint(Index point);

  // The edges that a segment crosses.
  struct Path {
    std::deque<Index> crossed;
    bool isFree = true;             // neither segments nor points are in the way
    Index edge = HalfEdges::kNone;  // the segment itself, where it is an edge
  };
  [[nodiscard]] Path path(Index segment, Index from, Index to);
  [[nodiscard]] Index firstCrossed(Index segment, Index from, Index to, Path& path);

  [[nodiscard]] bool isConvex(Index h) const;
  [[nodiscard]] bool improves(Index h) const;

  [[nodiscard]] std::uint64_t random() { return mixed(++drawn_); }

  const TrianglePlane& plane_;
  HalfEdges mesh_;
  Index near_ = 0;  // a half edge near the last point
  std::uint64_t drawn_ = 0;
  std::vector<bool> coincides_;  // [points] left out
  std::vector<Index> changed_;   // edges made by segments
  Triangulation result_;
};

void Triangulator::addPoints(const Progress* progress) {
  for (const std::uint32_t point : plane_.sorted()) {
    throwIfCancelled(progress);
    addPoint(point);
  }
}

// Walks to the triangle that contains a point.  Edges are tried in random order: a walk in a
// triangulation that is not Delaunay may go in circles otherwise.
//   source  Devillers, Pion, Teillaud: Walking in a Triangulation, 2001
Triangulator::Location Triangulator::locate(Index point) {
  Index h = near_;
  for (bool isThere = false; !isThere;) {
    isThere = true;
    for (std::uint64_t turn = random() % 3; turn > 0; --turn) h = mesh_.next(h);
    for (int k = 0; k < 3; ++k, h = mesh_.next(h)) {
      if (plane_.orientation(mesh_.origin(h), mesh_.target(h), point) >= 0) continue;
      h = HalfEdges::twin(h);
      assert(!mesh_.isOuter(h));
      isThere = false;
      break;
    }
  }
  std::array<Index, 3> on{};
  std::size_t count = 0;
  for (int k = 0; k < 3; ++k, h = mesh_.next(h)) {
    if (plane_.orientation(mesh_.origin(h), mesh_.target(h), point) == 0) on[count++] = h;
  }
  if (count == 0) return {Location::Kind::inside, h};
  if (count == 1) return {Location::Kind::onEdge, on[0]};
  // The vertex that both edges have.
  return {Location::Kind::atVertex, mesh_.next(on[0]) == on[1] ? on[1] : on[0]};
}

void Triangulator::addPoint(Index point) {
  const Location location = locate(point);
  near_ = location.halfEdge;
  switch (location.kind) {
    case Location::Kind::atVertex:
      result_.coincident.push_back({mesh_.origin(location.halfEdge), point});
      coincides_[point] = true;
      return;
    case Location::Kind::inside:
      mesh_.splitTriangle(location.halfEdge, point);
      break;
    case Location::Kind::onEdge:
      mesh_.splitEdge(location.halfEdge, point);
      break;
  }
  // Each flip adds an edge from the point, so that the flips end.
  std::vector<Index> opposite;
  for (const Index h : mesh_.around(point)) opposite.push_back(mesh_.next(h));
  while (!opposite.empty()) {
    const Index h = opposite.back();
    opposite.pop_back();
    if (!improves(h)) continue;
    mesh_.flip(h);
    for (const Index side : {h, HalfEdges::twin(h)}) {
      for (const Index edge : {mesh_.next(side), mesh_.after(side)}) {
        if (mesh_.origin(edge) != point && mesh_.target(edge) != point) opposite.push_back(edge);
      }
    }
  }
  near_ = mesh_.from(point);
}

// Returns true if the other diagonal of an edge's two triangles is inside them.
bool Triangulator::isConvex(Index h) const {
  const Index g = HalfEdges::twin(h), c = mesh_.apex(h), d = mesh_.apex(g);
  return plane_.orientation(d, c, mesh_.origin(h)) > 0 &&
         plane_.orientation(c, d, mesh_.origin(g)) > 0;
}

bool Triangulator::improves(Index h) const {
  if (mesh_.isBoundary(h) || mesh_.segment(h) != HalfEdges::kNone) return false;
  return plane_.isInCircle(mesh_.origin(h), mesh_.target(h), mesh_.apex(h),
                           mesh_.apex(HalfEdges::twin(h))) &&
         isConvex(h);
}

// Returns the first edge that a segment crosses, or kNone where `path` says why there is none.
Index Triangulator::firstCrossed(Index segment, Index from, Index to, Path& path) {
  for (const Index h : mesh_.around(from)) {
    if (mesh_.target(h) == to || mesh_.apex(h) == to) {
      path.edge = mesh_.target(h) == to ? h : mesh_.after(h);
      if (mesh_.segment(path.edge) == HalfEdges::kNone) return HalfEdges::kNone;
      result_.crossing.push_back({mesh_.segment(path.edge), segment});
      path.isFree = false;
      return HalfEdges::kNone;
    }
  }
  for (const Index h : mesh_.around(from)) {
    const int side = plane_.orientation(from, mesh_.target(h), to);
    if (side < 0 || plane_.orientation(from, mesh_.apex(h), to) >= 0) continue;
    if (side > 0) return mesh_.next(h);
    result_.onSegment.push_back({mesh_.target(h), segment});
    break;
  }
  path.isFree = false;
  return HalfEdges::kNone;
}

Triangulator::Path Triangulator::path(Index segment, Index from, Index to) {
  Path path;
  Index h = firstCrossed(segment, from, to, path);
  while (h != HalfEdges::kNone) {
    if (mesh_.segment(h) != HalfEdges::kNone) {
      result_.crossing.push_back({mesh_.segment(h), segment});
      path.isFree = false;
    }
    path.crossed.push_back(h);
    h = HalfEdges::twin(h);
    assert(!mesh_.isOuter(h));
    const Index apex = mesh_.apex(h);
    if (apex == to) break;
    const int side = plane_.orientation(from, to, apex);
    if (side == 0) {
      result_.onSegment.push_back({apex, segment});
      path.isFree = false;
      break;
    }
    // From the segment's left to its right; the next one from right to left.
    h = side > 0 ? mesh_.next(h) : mesh_.after(h);
  }
  return path;
}

void Triangulator::addSegment(Index segment, Index from, Index to) {
  if (coincides_[from] || coincides_[to]) return;
  Path way = path(segment, from, to);
  if (!way.isFree) return;
  Index edge = way.edge;
  while (!way.crossed.empty()) {
    const Index h = way.crossed.front();
    way.crossed.pop_front();
    const Index c = mesh_.apex(h), d = mesh_.apex(HalfEdges::twin(h));
    const auto side = [&](Index p) {
      return p == from || p == to ? 0 : plane_.orientation(from, to, p);
    };
    const bool stillCrosses = side(c) * side(d) < 0;
    // A flip to another edge that crosses is needed at times, and at times undone by the next: by
    // chance, the sequence that ends is found.
    if (!isConvex(h) || (stillCrosses && random() % 2 == 0)) {
      way.crossed.push_back(h);
      continue;
    }
    mesh_.flip(h);
    if (stillCrosses) {
      way.crossed.push_back(h);
    } else {
      changed_.push_back(h);
      if ((c == from && d == to) || (c == to && d == from)) edge = h;
    }
  }
  assert(edge != HalfEdges::kNone);
  mesh_.setSegment(edge, segment);
}

void Triangulator::improve() {
  if (changed_.empty()) return;
  constexpr std::size_t kFlipsPerEdge = 4;
  std::size_t left = kFlipsPerEdge * mesh_.halfEdges();
  std::vector<Index> waiting = std::move(changed_);
  while (!waiting.empty() && left > 0) {
    const Index h = waiting.back();
    waiting.pop_back();
    if (!improves(h)) continue;
    mesh_.flip(h);
    --left;
    for (const Index side : {h, HalfEdges::twin(h)}) {
      waiting.insert(waiting.end(), {mesh_.next(side), mesh_.after(side)});
    }
  }
}

Triangulation Triangulator::result() {
  for (Index h = 0; h < mesh_.halfEdges(); ++h) {
    if (mesh_.isOuter(h)) continue;
    const Index h1 = mesh_.next(h), h2 = mesh_.after(h);
    if (h > h1 || h > h2) continue;  // once per triangle
    const glm::uvec3 corner(mesh_.origin(h), mesh_.origin(h1), mesh_.origin(h2));
    const glm::uvec3 segment(mesh_.segment(h), mesh_.segment(h1), mesh_.segment(h2));
    result_.triangles.push_back(corner);
    result_.segments.push_back(segment);
  }
  return std::move(result_);
}

}  // namespace

Triangulation triangulate(std::span<const TrianglePoint> points,
                          std::span<const std::array<std::uint32_t, 2>> segments,
                          const Progress* progress) {
  assert(points.size() >= 3);
  const TrianglePlane plane(points);
  if (plane.isFlat()) {
    Triangulation flat;
    flat.isFlat = true;
    return flat;
  }
  Triangulator triangulator(points, plane);
  triangulator.addPoints(progress);
  for (Index i = 0; i < segments.size(); ++i) {
    throwIfCancelled(progress);
    triangulator.addSegment(i, segments[i][0], segments[i][1]);
  }
  triangulator.improve();
  return triangulator.result();
}

}  // namespace sherd
