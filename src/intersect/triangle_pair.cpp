// Where two triangles in general position cross.
#include "intersect/triangle_pair.h"

#include <algorithm>
#include <cassert>

#include "intersect/crossing_point.h"
#include "intersect/predicates.h"

namespace sherd {
namespace {

using Signs = std::array<int, 3>;

// The sides of a plane that a triangle's corners are on.
Signs sidesOf(const PairTriangle& triangle, const PairTriangle& plane) {
  const auto& [a, b, c] = plane.corner;
  Signs sides{};
  for (std::size_t k = 0; k < 3; ++k) sides[k] = orientation(a, b, c, triangle.corner[k]);
  return sides;
}

bool areEqualAndNot0(const Signs& s) { return s[0] != 0 && s[0] == s[1] && s[1] == s[2]; }

bool areAll0(const Signs& s) { return s[0] == 0 && s[1] == 0 && s[2] == 0; }

// How an edge of a triangle meets another triangle.
struct EdgeHit {
  bool isThere = false;
  Signs passes{};  // the side of each of the other triangle's edges that the edge passes on
};

// `sides` are those of the edge's triangle.  If a sign is 0 the edge may only touch.
EdgeHit hitOf(const PairTriangle& own, std::size_t edge, const Signs& sides,
              const PairTriangle& other) {
  const std::size_t end = (edge + 1) % 3;
  EdgeHit hit;
  if (sides[edge] != 0 && sides[edge] == sides[end]) return hit;
  for (std::size_t k = 0; k < 3; ++k) {
    hit.passes[k] =
        orientation(own.corner[edge], own.corner[end], other.corner[k], other.corner[(k + 1) % 3]);
  }
  const auto [least, most] = std::minmax({hit.passes[0], hit.passes[1], hit.passes[2]});
  hit.isThere = least >= 0 || most <= 0;
  return hit;
}

class PairTest {
 public:
  PairTest(const PairTriangle& surface, const PairTriangle& cutter)
      : surface_(surface), cutter_(cutter) {}

  [[nodiscard]] TrianglePair run();

 private:
  void testSurfaceEdge(std::size_t edge);
  void testCutterEdge(std::size_t edge);
  void addEnd(const CrossingKey& key, bool isFrom);

  const PairTriangle &surface_, &cutter_;
  Signs surfaceSides_{}, cutterSides_{};
  int hits_ = 0;
  TrianglePair pair_;
};

TrianglePair PairTest::run() {
  cutterSides_ = sidesOf(cutter_, surface_);
  if (areEqualAndNot0(cutterSides_)) return {};
  surfaceSides_ = sidesOf(surface_, cutter_);
  if (areEqualAndNot0(surfaceSides_)) return {};
  for (std::size_t edge = 0; edge < 3; ++edge) {
    testSurfaceEdge(edge);
    testCutterEdge(edge);
  }
  if (hits_ == 0) return {};
  if (areAll0(cutterSides_)) pair_.isSurfaceFlat = areCollinear(surface_.corner);
  if (areAll0(cutterSides_) || areAll0(surfaceSides_)) {
    for (int k = 0; k < 3; ++k) pair_.cutterVertices.push_back(cutter_.vertex[k]);
  }
  pair_.kind =
      pair_.cutterVertices.empty() ? TrianglePair::Kind::crossing : TrianglePair::Kind::degenerate;
  assert(pair_.kind == TrianglePair::Kind::degenerate || hits_ == 2);
  return pair_;
}

void PairTest::addEnd(const CrossingKey& key, bool isFrom) {
  (isFrom ? pair_.from : pair_.to) = key;
}

void PairTest::testSurfaceEdge(std::size_t edge) {
  const EdgeHit hit = hitOf(surface_, edge, surfaceSides_, cutter_);
  if (!hit.isThere) return;
  ++hits_;
  const std::size_t end = (edge + 1) % 3;
  if (surfaceSides_[edge] == 0 || surfaceSides_[end] == 0) {
    for (int k = 0; k < 3; ++k) pair_.cutterVertices.push_back(cutter_.vertex[k]);
  }
  for (int k = 0; k < 3; ++k) {
    if (hit.passes[static_cast<std::size_t>(k)] != 0) continue;
    pair_.cutterVertices.insert(pair_.cutterVertices.end(),
                                {cutter_.vertex[k], cutter_.vertex[(k + 1) % 3]});
  }
  const std::uint32_t a = surface_.vertex[static_cast<int>(edge)],
                      b = surface_.vertex[static_cast<int>(end)];
  // A path that enters a triangle over its edge has the edge's start on its left.
  addEnd({false, std::min(a, b), std::max(a, b), cutter_.index}, surfaceSides_[edge] < 0);
}

void PairTest::testCutterEdge(std::size_t edge) {
  const EdgeHit hit = hitOf(cutter_, edge, cutterSides_, surface_);
  if (!hit.isThere) return;
  ++hits_;
  const std::size_t end = (edge + 1) % 3;
  const std::uint32_t a = cutter_.vertex[static_cast<int>(edge)],
                      b = cutter_.vertex[static_cast<int>(end)];
  if (cutterSides_[edge] == 0) pair_.cutterVertices.push_back(a);
  if (cutterSides_[end] == 0) pair_.cutterVertices.push_back(b);
  if (std::count(hit.passes.begin(), hit.passes.end(), 0) > 0) {
    pair_.cutterVertices.insert(pair_.cutterVertices.end(), {a, b});
  }
  addEnd({true, std::min(a, b), std::max(a, b), surface_.index}, cutterSides_[edge] > 0);
}

}  // namespace

TrianglePair meetingOf(const PairTriangle& surface, const PairTriangle& cutter) {
  return PairTest(surface, cutter).run();
}

}  // namespace sherd
