// Triangles of one mesh that cross each other.
#include "intersect/self_crossings.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "base/cancel_flag.h"
#include "intersect/crossing_point.h"
#include "intersect/predicates.h"
#include "mesh/largest_axis.h"
#include "mesh/search/boxes.h"
#include "mesh/search/triangle_tree.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

constexpr std::size_t kTaskTriangles = 512;  // triangles that a task processes

// Triangles beside each other whose neighbors are looked up together.
constexpr std::size_t kGroup = 8;

// Where at most one triangle in so many is tested, those near them are looked up first.
constexpr std::size_t kFew = 4;

using Corners = std::array<glm::dvec3, 3>;

// Whether a segment in the plane of a triangle meets it.
bool meetsInPlane(const glm::dvec3& p, const glm::dvec3& q, const Corners& t) {
  const int axis = largestAxis(glm::cross(t[1] - t[0], t[2] - t[0]));
  const ExactPoint a(p), b(q);
  const std::array<ExactPoint, 3> corner{ExactPoint(t[0]), ExactPoint(t[1]), ExactPoint(t[2])};
  const auto areApart = [](int left, int right) { return left * right > 0; };
  std::array<int, 3> ofP{}, ofQ{};  // sides of the triangle's edges
  for (std::size_t k = 0; k < 3; ++k) {
    const ExactPoint &from = corner[k], &to = corner[(k + 1) % 3];
    ofP[k] = orientation(from, to, a, axis);
    ofQ[k] = orientation(from, to, b, axis);
    const int ofFrom = orientation(a, b, from, axis), ofTo = orientation(a, b, to, axis);
    if (areApart(ofP[k], ofQ[k]) || areApart(ofFrom, ofTo)) continue;
    const bool areInLine = ofP[k] == 0 && ofQ[k] == 0 && ofFrom == 0 && ofTo == 0;
    if (!areInLine || meet(boxOf({p, q, q}), boxOf({from.rounded, to.rounded, to.rounded}))) {
      return true;
    }
  }
  return ofP[0] == ofP[1] && ofP[1] == ofP[2];  // within
}

// Whether a segment meets a triangle, whose border belongs to it.
bool meets(const glm::dvec3& p, const glm::dvec3& q, const Corners& t) {
  const int atP = orientation(t[0], t[1], t[2], p), atQ = orientation(t[0], t[1], t[2], q);
  // Every point is in the plane of a triangle without area.  Its edges are tested against the other
  // triangle.
  if (atP == 0 && atQ == 0) return !areCollinear(t) && meetsInPlane(p, q, t);
  if (atP == atQ) return false;
  int least = 1, most = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const int side = orientation(p, q, t[k], t[(k + 1) % 3]);
    least = std::min(least, side);
    most = std::max(most, side);
  }
  return least >= 0 || most <= 0;
}

// [corners of a] whether it is one of b.
std::array<bool, 3> shared(const glm::uvec3& a, const glm::uvec3& b) {
  std::array<bool, 3> is{};
  for (int k = 0; k < 3; ++k)
    is[static_cast<std::size_t>(k)] = a[k] == b.x || a[k] == b.y || a[k] == b.z;
  return is;
}

// Whether the edges of a triangle meet another, other than at common corners.
bool edgesMeet(const Corners& own, const std::array<bool, 3>& isShared, std::ptrdiff_t common,
               const Corners& other) {
  const Box box = boxOf(other);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t end = (k + 1) % 3;
    if (common > 0 && (isShared[k] || isShared[end])) continue;
    // Saves exact arithmetic for triangles in one plane beside each other.
    if (!meet(boxOf({own[k], own[end], own[end]}), box)) continue;
    if (meets(own[k], own[end], other)) return true;
  }
  return false;
}

// Of triangles with a common edge: whether they are in one plane, on one side of it.
bool areFolded(const Corners& s, const std::array<bool, 3>& inT, const Corners& t,
               const std::array<bool, 3>& inS) {
  const auto free = [](const std::array<bool, 3>& is) {
    return static_cast<std::size_t>(std::find(is.begin(), is.end(), false) - is.begin());
  };
  const glm::dvec3 &p = t[free(inS)], &q = s[free(inT)];
  if (orientation(s[0], s[1], s[2], p) != 0) return false;
  const ExactPoint from(s[(free(inT) + 1) % 3]), to(s[(free(inT) + 2) % 3]);
  for (int axis = 0; axis < 3; ++axis) {
    const int ofP = orientation(from, to, ExactPoint(p), axis);
    const int ofQ = orientation(from, to, ExactPoint(q), axis);
    if (ofP * ofQ != 0) return ofP == ofQ;
  }
  return true;  // one has no area
}

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

// The tests of all pairs that count.
class PairTests {
 public:
  PairTests(std::span<const glm::dvec3> vertices, std::span<const glm::uvec3> triangles,
            const CrossingPairs& tested)
      : vertices_(vertices),
        triangles_(triangles),
        tested_(tested),
        tree_({{vertices.begin(), vertices.end()}, {triangles.begin(), triangles.end()}}) {}

  [[nodiscard]] Pairs run(const Progress* progress) const {
    const std::size_t blocks = (triangles_.size() + kTaskTriangles - 1) / kTaskTriangles;
    std::vector<Pairs> found(blocks);
    CancelFlag stop(progress);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
      std::vector<std::uint32_t> near;
      const std::size_t end = std::min(triangles_.size(), (block + 1) * kTaskTriangles);
      for (std::size_t i = block * kTaskTriangles; i < end && !stop.isSet(); i += kGroup) {
        testGroup(i, std::min(i + kGroup, end), near, found[block]);
      }
    });
    stop.throwIfSet();
    Pairs all;
    for (const Pairs& own : found) all.insert(all.end(), own.begin(), own.end());
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  [[nodiscard]] bool isOf(std::uint32_t t) const {
    return tested_.of.empty() || tested_.of[t] != 0;
  }

  // Tests triangles of the tree's order with all that are near.
  //   near  reused
  void testGroup(std::size_t begin, std::size_t end, std::vector<std::uint32_t>& near,
                 Pairs& found) const {
    std::array<Box, kGroup> boxes{};
    Box all{glm::dvec3(std::numeric_limits<double>::infinity()),
            glm::dvec3(-std::numeric_limits<double>::infinity())};
    for (std::size_t i = begin; i < end; ++i) {
      if (!isOf(tree_.source(i))) continue;
      Box& own = boxes[i - begin] = boxOf(tree_.corners(i));
      all = {glm::min(all.min, own.min), glm::max(all.max, own.max)};
    }
    tree_.findMeeting(all, near);
    for (const std::uint32_t j : near) {
      const std::uint32_t other = tree_.source(j);
      const Box box = boxOf(tree_.corners(j));
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t t = tree_.source(i);
        // Of two that both count, the lower one finds the pair.
        if (other == t || !isOf(t) || (other < t && isOf(other))) continue;
        if (!meet(boxes[i - begin], box) || areOfOne(t, other)) continue;
        if (!trianglesCross(vertices_, triangles_[t], triangles_[other])) continue;
        found.push_back({std::min(t, other), std::max(t, other)});
      }
    }
  }

  [[nodiscard]] bool areOfOne(std::uint32_t a, std::uint32_t b) const {
    return !tested_.source.empty() && tested_.source[a] == tested_.source[b];
  }

  const std::span<const glm::dvec3> vertices_;
  const std::span<const glm::uvec3> triangles_;
  const CrossingPairs tested_;
  const TriangleTree tree_;
};

// The triangles that are tested, and those whose boxes meet theirs, ascending.
std::vector<std::uint32_t> nearTested(std::span<const glm::dvec3> vertices,
                                      std::span<const glm::uvec3> triangles,
                                      std::span<const std::uint8_t> isTested) {
  TriangleMesh few{{vertices.begin(), vertices.end()}, {}};
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (isTested[t] != 0) few.triangles.push_back(triangles[t]);
  }
  const TriangleTree tree(few);
  std::vector<std::uint8_t> isNear(triangles.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.size(), kTaskTriangles),
                    [&](const auto& range) {
                      for (std::size_t t = range.begin(); t < range.end(); ++t) {
                        isNear[t] = tree.isAnyMeeting(boxOf(positionsOf(vertices, triangles[t])));
                      }
                    });
  std::vector<std::uint32_t> near;
  for (std::uint32_t t = 0; t < isNear.size(); ++t) {
    if (isNear[t] != 0) near.push_back(t);
  }
  return near;
}

}  // namespace

bool trianglesCross(std::span<const glm::dvec3> vertices, const glm::uvec3& a,
                    const glm::uvec3& b) {
  const std::array<bool, 3> inB = shared(a, b), inA = shared(b, a);
  const auto common = std::count(inB.begin(), inB.end(), true);
  const Corners s = positionsOf(vertices, a), t = positionsOf(vertices, b);
  if (common >= 2) return common == 3 || areFolded(s, inB, t, inA);
  return edgesMeet(s, inB, common, t) || edgesMeet(t, inA, common, s);
}

Pairs selfCrossings(std::span<const glm::dvec3> vertices, std::span<const glm::uvec3> triangles,
                    const Progress* progress, const CrossingPairs& tested) {
  const std::span<const std::uint8_t> of = tested.of;
  if (of.empty()) return PairTests(vertices, triangles, tested).run(progress);
  const auto count = static_cast<std::size_t>(std::count(of.begin(), of.end(), 1));
  if (count == 0) return {};
  if (count > of.size() / kFew) return PairTests(vertices, triangles, tested).run(progress);
  const std::vector<std::uint32_t> near = nearTested(vertices, triangles, of);
  std::vector<glm::uvec3> ofNear;
  std::vector<std::uint8_t> isTested;
  std::vector<std::uint32_t> source;
  for (const std::uint32_t t : near) {
    ofNear.push_back(triangles[t]);
    isTested.push_back(of[t]);
    if (!tested.source.empty()) source.push_back(tested.source[t]);
  }
  Pairs pairs = PairTests(vertices, ofNear, {.of = isTested, .source = source}).run(progress);
  for (auto& pair : pairs) pair = {near[pair[0]], near[pair[1]]};
  return pairs;
}

}  // namespace sherd
