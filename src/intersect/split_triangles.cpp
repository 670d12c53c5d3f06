// Splits the crossed triangles of one mesh along their seams.
#include "intersect/split_triangles.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>

#include "base/cancel_flag.h"
#include "base/sort_unique.h"
#include "intersect/triangulate.h"

namespace sherd {
namespace {

// The seams of every triangle of a side: those of triangle i are
// seams[first[i]] .. seams[first[i + 1]] - 1.
struct SeamsOfTriangles {
  std::vector<std::uint32_t> first, seams;

  SeamsOfTriangles(const CutSide& side, const std::vector<Seam>& all)
      : first(side.triangles.size() + 1, 0), seams(all.size()) {
    const auto triangleOf = [&](const Seam& seam) { return side.isCutter ? seam.c : seam.s; };
    for (const Seam& seam : all) ++first[triangleOf(seam) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::uint32_t> end(first.begin(), first.end() - 1);
    for (std::uint32_t i = 0; i < all.size(); ++i) seams[end[triangleOf(all[i])]++] = i;
  }

  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t triangle) const {
    return std::span(seams).subspan(first[triangle], first[triangle + 1] - first[triangle]);
  }
};

// The edge of a triangle that a crossing is on, as a bit; 0 if it is inside.
std::uint8_t edgeOf(const CrossingKey& key, const CutSide& side, const glm::uvec3& triangle) {
  if (key.isCutterEdge != side.isCutter) return 0;
  for (int k = 0; k < 3; ++k) {
    const auto [low, high] = std::minmax({triangle[k], triangle[(k + 1) % 3]});
    if (low == key.low && high == key.high) return static_cast<std::uint8_t>(1 << k);
  }
  return 0;
}

class TriangleSplit {
 public:
  TriangleSplit(const CutSide& side, const std::vector<glm::uvec3>& cutters,
                const CrossingPoints& crossings, const std::vector<Seam>& seams)
      : side_(side), cutters_(cutters), crossings_(crossings), seams_(seams) {}

  // Appends the parts of a triangle.
  void split(std::uint32_t triangle, std::span<const std::uint32_t> ownSeams, SplitTriangles& out);

 private:
  void addPoints(std::uint32_t triangle, std::span<const std::uint32_t> ownSeams);
  void addFailures(std::uint32_t triangle, std::span<const std::uint32_t> ownSeams,
                   const Triangulation& parts, SplitTriangles& out) const;
  void addCutter(std::uint32_t c, std::vector<std::uint32_t>& degenerate) const;
  void addPoint(std::uint32_t local, std::vector<std::uint32_t>& degenerate) const;

  const CutSide& side_;
  const std::vector<glm::uvec3>& cutters_;
  const CrossingPoints& crossings_;
  const std::vector<Seam>& seams_;
  // Of the triangle at hand:
  std::vector<std::uint32_t> vertices_;  // the corners, then the crossings, ascending
  std::vector<TrianglePoint> points_;    // [vertices_]
};

void TriangleSplit::addPoints(std::uint32_t triangle, std::span<const std::uint32_t> ownSeams) {
  const glm::uvec3& corner = side_.triangles[triangle];
  vertices_.clear();
  for (const std::uint32_t i : ownSeams) {
    vertices_.insert(vertices_.end(), {seams_[i].from, seams_[i].to});
  }
  sortUnique(vertices_);
  points_.clear();
  for (int k = 0; k < 3; ++k) {
    points_.push_back(
        {ExactPoint(side_.vertices[corner[k]]), kCornerEdges[static_cast<std::size_t>(k)]});
  }
  for (const std::uint32_t vertex : vertices_) {
    points_.push_back({crossings_.points[vertex - crossings_.first],
                       edgeOf(crossings_.key(vertex), side_, corner)});
  }
  vertices_.insert(vertices_.begin(), {side_.firstVertex + corner.x, side_.firstVertex + corner.y,
                                       side_.firstVertex + corner.z});
}

void TriangleSplit::split(std::uint32_t triangle, std::span<const std::uint32_t> ownSeams,
                          SplitTriangles& out) {
  addPoints(triangle, ownSeams);
  const auto local = [&](std::uint32_t vertex) {
    const auto found = std::lower_bound(vertices_.begin() + 3, vertices_.end(), vertex);
    return static_cast<std::uint32_t>(found - vertices_.begin());
  };
  std::vector<std::array<std::uint32_t, 2>> segments;
  segments.reserve(ownSeams.size());
  for (const std::uint32_t i : ownSeams) {
    segments.push_back({local(seams_[i].from), local(seams_[i].to)});
  }
  const Triangulation parts = triangulate(points_, segments);
  if (!parts.isComplete()) addFailures(triangle, ownSeams, parts, out);
  for (const glm::uvec3& t : parts.triangles) {
    out.parts.push_back({{vertices_[t.x], vertices_[t.y], vertices_[t.z]}, triangle});
  }
}

void TriangleSplit::addFailures(std::uint32_t triangle, std::span<const std::uint32_t> ownSeams,
                                const Triangulation& parts, SplitTriangles& out) const {
  for (const auto& [a, b] : parts.crossing) {
    out.crossingSeams.push_back({ownSeams[a], ownSeams[b]});
  }
  for (const auto& [point, segment] : parts.onSegment) {
    addPoint(point, out.degenerate);
    addCutter(seams_[ownSeams[segment]].c, out.degenerate);
  }
  for (const auto& [a, b] : parts.coincident) {
    addPoint(a, out.degenerate);
    addPoint(b, out.degenerate);
  }
  if (!parts.isFlat) return;
  if (side_.isCutter) {
    addCutter(triangle, out.degenerate);
  } else {
    out.flat.push_back(triangle);
  }
}

void TriangleSplit::addCutter(std::uint32_t c, std::vector<std::uint32_t>& degenerate) const {
  for (int k = 0; k < 3; ++k) degenerate.push_back(cutters_[c][k]);
}

// Adds the cutters' vertices that a point depends on.
void TriangleSplit::addPoint(std::uint32_t local, std::vector<std::uint32_t>& degenerate) const {
  if (local < 3) return;
  const CrossingKey& key = crossings_.key(vertices_[local]);
  if (key.isCutterEdge) {
    degenerate.insert(degenerate.end(), {key.low, key.high});
  } else {
    addCutter(key.triangle, degenerate);
  }
}

template <class T>
void appendAll(std::vector<T>& all, const std::vector<T>& part) {
  all.insert(all.end(), part.begin(), part.end());
}

}  // namespace

SplitTriangles splitTriangles(const CutSide& side, const std::vector<glm::uvec3>& cutters,
                              const CrossingPoints& crossings, const std::vector<Seam>& seams,
                              const Progress* progress) {
  SplitTriangles all;
  all.isCrossed.assign(side.triangles.size(), 0);
  const SeamsOfTriangles of(side, seams);
  std::vector<std::uint32_t> crossed;
  for (std::uint32_t i = 0; i < side.triangles.size(); ++i) {
    if (of.of(i).empty()) continue;
    all.isCrossed[i] = 1;
    crossed.push_back(i);
  }
  // Blocks are the same for any number of threads, so that their results are, too.
  constexpr std::size_t kBlock = 64;
  std::vector<SplitTriangles> found((crossed.size() + kBlock - 1) / kBlock);
  CancelFlag cancel(progress);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t block) {
    if (cancel.isSet()) return;
    TriangleSplit split(side, cutters, crossings, seams);
    const std::size_t end = std::min(crossed.size(), (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < end; ++i) {
      split.split(crossed[i], of.of(crossed[i]), found[block]);
    }
  });
  cancel.throwIfSet();
  for (const SplitTriangles& part : found) {
    appendAll(all.parts, part.parts);
    appendAll(all.crossingSeams, part.crossingSeams);
    appendAll(all.degenerate, part.degenerate);
    appendAll(all.flat, part.flat);
  }
  return all;
}

}  // namespace sherd
