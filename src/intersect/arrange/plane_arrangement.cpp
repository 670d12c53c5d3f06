// Triangulates what triangles of one plane cover.
#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <string>
#include <unordered_map>
#include <utility>

#include "base/cancel_flag.h"
#include "base/sort_unique.h"
#include "intersect/arrange/arrangement.h"
#include "intersect/homogeneous_point.h"
#include "intersect/triangulate.h"
#include "mesh/largest_axis.h"

namespace sherd {
namespace {

using Index = std::uint32_t;

class PlaneArrangement {
 public:
  PlaneArrangement(std::span<const PlaneTriangle> triangles, std::vector<ArrangedLine> lines,
                   std::vector<Index> points, PointSet& all, const Progress* progress)
      : triangles_(triangles), all_(all), progress_(progress) {
    lines_ = std::move(lines);
    sortUnique(lines_);
    firstBorder_ = lines_.size();
    // One triangle's border is that of its triangulation.
    if (triangles.size() > 1) addBorders();
    for (const ArrangedLine& line : lines_) points.insert(points.end(), {line.from, line.to});
    if (triangles.size() == 1) {
      sortUnique(points);
      const glm::uvec3& c = triangles[0].corner;
      std::erase_if(points, [&](Index p) { return p == c.x || p == c.y || p == c.z; });
      points.insert(points.begin(), {c.x, c.y, c.z});
    } else {
      sortUnique(points);
    }
    for (const Index p : points) addPoint(p);
    chains_.resize(lines_.size());
    for (std::size_t i = 0; i < lines_.size(); ++i) chains_[i] = {lines_[i].from, lines_[i].to};
  }

  // Returns why that failed, as a clause, or nothing.
  std::string triangulateAll();
  void appendTriangles(std::vector<ArrangedTriangle>& out) const;

 private:
  static constexpr int kMostPasses = 64;
  // Of lines that cross each other in one plane: each costs an exact test for each line, together
  // some seconds.
  static constexpr std::size_t kMostCrossings = 4096;
  static constexpr Index kFrame = 0xffffffffu;  // in numbers_: of a corner around all triangles

  void addBorders();
  void addFrame();
  void addPoint(Index number);
  void findAxis();
  [[nodiscard]] const ExactPoint& at(Index local) const { return points_[local].point; }
  [[nodiscard]] Index local(Index number) const { return localOf_.at(number); }

  void splitLines(std::size_t firstNew);
  void splitLine(std::size_t line, std::span<const Index> candidates);
  void makeSegments();
  bool addCrossings(const Triangulation& parts);

  [[nodiscard]] bool isInFront(const glm::uvec3& corner) const {
    return orientation(at(local(corner.x)), at(local(corner.y)), at(local(corner.z)), axis_) > 0;
  }
  void appendSingle(std::vector<ArrangedTriangle>& out) const;
  void cover(std::size_t triangle, const std::unordered_map<std::uint64_t, Index>& left,
             std::vector<Index>& covered) const;

  std::span<const PlaneTriangle> triangles_;
  PointSet& all_;
  const Progress* progress_;
  int axis_ = 0;
  std::vector<ArrangedLine> lines_;  // by numbers of points; three of each triangle come last
  std::size_t firstBorder_ = 0;
  std::vector<std::vector<Index>> chains_;  // [lines] the numbers of all points on it, in order
  std::vector<TrianglePoint> points_;       // the frame or the triangle, then all others
  std::vector<Index> numbers_;              // [points_]
  std::unordered_map<Index, Index> localOf_;
  std::vector<std::array<Index, 2>> segments_;  // by points_
  std::vector<Index> lineOf_;                   // [segments_] one of its lines
  std::size_t crossings_ = 0;                   // that were found so far
  Triangulation parts_;
};

void PlaneArrangement::addBorders() {
  for (const PlaneTriangle& t : triangles_) {
    for (int k = 0; k < 3; ++k) lines_.push_back({t.corner[k], t.corner[(k + 1) % 3]});
  }
  findAxis();
  addFrame();
}

// The axis along which the first triangle is seen with the largest area.
void PlaneArrangement::findAxis() {
  const glm::uvec3& c = triangles_[0].corner;
  const std::array<ExactPoint, 3> t{all_.at(c.x), all_.at(c.y), all_.at(c.z)};
  const int first =
      largestAxis(glm::cross(t[1].rounded - t[0].rounded, t[2].rounded - t[0].rounded));
  for (int i = 0; i < 3; ++i) {
    axis_ = (first + i) % 3;
    if (orientation(t[0], t[1], t[2], axis_) != 0) return;
  }
}

// Adds a triangle around all others, as seen along the axis: where it lies along that does not
// matter.
void PlaneArrangement::addFrame() {
  glm::dvec3 low = all_.rounded(triangles_[0].corner.x), high = low;
  for (const PlaneTriangle& t : triangles_) {
    for (int k = 0; k < 3; ++k) {
      low = glm::min(low, all_.rounded(t.corner[k]));
      high = glm::max(high, all_.rounded(t.corner[k]));
    }
  }
  const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
  const glm::dvec3 middle = (low + high) / 2.0;
  const double reach = 4.0 * std::max(high[u] - low[u], high[v] - low[v]);
  for (const auto& [x, y] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {0.0, 1.0}}) {
    glm::dvec3 corner = middle;
    corner[u] += x * reach;
    corner[v] += y * reach;
    points_.push_back({ExactPoint(corner), kCornerEdges[points_.size()]});
    numbers_.push_back(kFrame);
  }
}

void PlaneArrangement::addPoint(Index number) {
  localOf_[number] = static_cast<Index>(points_.size());
  const std::size_t i = points_.size();
  points_.push_back({all_.at(number), i < 3 ? kCornerEdges[i] : std::uint8_t{0}});
  numbers_.push_back(number);
}

// Adds the points on a line to its chain.
void PlaneArrangement::splitLine(std::size_t line, std::span<const Index> candidates) {
  const Index a = local(lines_[line].from), b = local(lines_[line].to);
  const ExactPoint &from = at(a), &to = at(b);
  const glm::dvec3 low = glm::min(from.rounded, to.rounded),
                   high = glm::max(from.rounded, to.rounded), size = high - low;
  int along = largestAxis(size);
  for (int i = 0; i < 2 && compare(from, to, along) == 0; ++i) along = (along + 1) % 3;
  const int direction = compare(to, from, along);
  const auto isBefore = [&](const ExactPoint& p, const ExactPoint& q) {
    return direction * compare(p, q, along) < 0;
  };
  std::vector<Index>& chain = chains_[line];
  const std::size_t before = chain.size();
  for (const Index i : candidates) {
    const ExactPoint& p = at(i);
    if (i == a || i == b || glm::clamp(p.rounded, low, high) != p.rounded) continue;
    if (orientation(from, to, p, axis_) != 0) continue;
    if (isBefore(from, p) && isBefore(p, to)) chain.push_back(numbers_[i]);
  }
  if (chain.size() == before) return;
  std::sort(chain.begin(), chain.end(),
            [&](Index p, Index q) { return p != q && isBefore(at(local(p)), at(local(q))); });
  chain.erase(std::unique(chain.begin(), chain.end()), chain.end());
}

// Adds points to the chains of the lines that they are on.
void PlaneArrangement::splitLines(std::size_t firstNew) {
  const std::array<int, 2> axes{(axis_ + 1) % 3, (axis_ + 2) % 3};
  std::array<std::vector<Index>, 2> sorted;  // along each axis
  for (std::size_t k = 0; k < 2; ++k) {
    sorted[k].resize(points_.size() - firstNew);
    std::iota(sorted[k].begin(), sorted[k].end(), static_cast<Index>(firstNew));
    std::sort(sorted[k].begin(), sorted[k].end(),
              [&](Index p, Index q) { return at(p).rounded[axes[k]] < at(q).rounded[axes[k]]; });
  }
  for (std::size_t line = 0; line < lines_.size(); ++line) {
    throwIfCancelled(progress_);
    const glm::dvec3 &p = at(local(lines_[line].from)).rounded,
                     &q = at(local(lines_[line].to)).rounded;
    std::array<std::span<const Index>, 2> between;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto coordinate = [&](Index i) { return at(i).rounded[axes[k]]; };
      const auto [low, high] = std::minmax({p[axes[k]], q[axes[k]]});
      const auto begin = std::ranges::lower_bound(sorted[k], low, {}, coordinate);
      const auto end = std::ranges::upper_bound(begin, sorted[k].end(), high, {}, coordinate);
      between[k] = std::span<const Index>(begin, end);
    }
    splitLine(line, between[0].size() < between[1].size() ? between[0] : between[1]);
  }
}

void PlaneArrangement::makeSegments() {
  std::map<std::array<Index, 2>, Index> lineOf;  // of a segment
  for (Index line = 0; line < chains_.size(); ++line) {
    for (std::size_t i = 0; i + 1 < chains_[line].size(); ++i) {
      const auto [low, high] = std::minmax({local(chains_[line][i]), local(chains_[line][i + 1])});
      lineOf.try_emplace({low, high}, line);
    }
  }
  segments_.clear();
  lineOf_.clear();
  for (const auto& [segment, line] : lineOf) {
    segments_.push_back(segment);
    lineOf_.push_back(line);
  }
}

// Adds the points where segments cross.  Returns false if there are none.
bool PlaneArrangement::addCrossings(const Triangulation& parts) {
  const std::size_t before = points_.size();
  for (const auto& [i, j] : parts.crossing) {
    throwIfCancelled(progress_);
    const auto endsOf = [&](Index segment) {
      const ArrangedLine& line = lines_[lineOf_[segment]];
      return std::array{all_.at(line.from), all_.at(line.to)};
    };
    const Index number = all_.add(lineCrossing(endsOf(i), endsOf(j), axis_));
    if (!localOf_.contains(number)) addPoint(number);
  }
  return points_.size() > before;
}

std::string PlaneArrangement::triangulateAll() {
  if (triangles_.size() == 1) findAxis();
  std::size_t firstNew = 0;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    splitLines(std::max(firstNew, triangles_.size() > 1 ? std::size_t{3} : std::size_t{0}));
    makeSegments();
    firstNew = points_.size();
    parts_ = triangulate(points_, segments_, progress_);
    if (parts_.isComplete()) return {};
    // Of each pass: those with the segments that are in its triangulation.
    crossings_ += parts_.crossing.size();
    if (crossings_ > kMostCrossings) {
      return "triangles cross each other more than " + std::to_string(kMostCrossings) +
             " times in one plane";
    }
    if (!addCrossings(parts_)) break;
  }
  return "the triangles in one plane that cross each other can't be divided";  // no known cause
}

void PlaneArrangement::appendSingle(std::vector<ArrangedTriangle>& out) const {
  for (const glm::uvec3& t : parts_.triangles) {
    out.push_back({{numbers_[t.x], numbers_[t.y], numbers_[t.z]}, triangles_[0].index});
  }
}

std::uint64_t edgeKey(Index from, Index to) { return std::uint64_t{from} << 32 | to; }

// Finds the parts that a triangle covers: those on the inner side of its border, and all that are
// connected to them without crossing it.
//   left  of a directed edge, the part on its left
void PlaneArrangement::cover(std::size_t triangle,
                             const std::unordered_map<std::uint64_t, Index>& left,
                             std::vector<Index>& covered) const {
  const bool isInFrontOfAxis = isInFront(triangles_[triangle].corner);
  std::unordered_map<std::uint64_t, bool> border;
  covered.clear();
  std::unordered_map<Index, bool> isCovered;
  const auto add = [&](Index part) {
    if (isCovered.try_emplace(part, true).second) covered.push_back(part);
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<Index>& chain = chains_[firstBorder_ + 3 * triangle + k];
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
      Index from = local(chain[i]), to = local(chain[i + 1]);
      if (!isInFrontOfAxis) std::swap(from, to);
      border[edgeKey(from, to)] = true;
      add(left.at(edgeKey(from, to)));
    }
  }
  for (std::size_t i = 0; i < covered.size(); ++i) {
    const glm::uvec3& t = parts_.triangles[covered[i]];
    for (int k = 0; k < 3; ++k) {
      const Index from = t[k], to = t[(k + 1) % 3];
      if (!border.contains(edgeKey(from, to))) add(left.at(edgeKey(to, from)));
    }
  }
}

void PlaneArrangement::appendTriangles(std::vector<ArrangedTriangle>& out) const {
  if (triangles_.size() == 1) return appendSingle(out);
  std::unordered_map<std::uint64_t, Index> left;
  for (Index p = 0; p < parts_.triangles.size(); ++p) {
    const glm::uvec3& t = parts_.triangles[p];
    for (int k = 0; k < 3; ++k) left[edgeKey(t[k], t[(k + 1) % 3])] = p;
  }
  struct Cover {
    int count = 0;                               // of those in front of the axis, minus the others
    std::array<Index, 2> first{kFrame, kFrame};  // of those behind and those in front
  };
  std::vector<Cover> covers(parts_.triangles.size());
  std::vector<Index> covered;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    cover(i, left, covered);
    const bool inFront = isInFront(triangles_[i].corner);
    for (const Index part : covered) {
      covers[part].count += inFront ? 1 : -1;
      Index& first = covers[part].first[inFront ? 1 : 0];
      first = std::min(first, triangles_[i].index);
    }
  }
  for (Index p = 0; p < covers.size(); ++p) {
    const int count = covers[p].count;
    if (count == 0) continue;
    const glm::uvec3& t = parts_.triangles[p];
    glm::uvec3 corner(numbers_[t.x], numbers_[t.y], numbers_[t.z]);
    if (count < 0) std::swap(corner.y, corner.z);
    out.push_back({corner, covers[p].first[count > 0 ? 1 : 0],
                   static_cast<std::uint32_t>(count > 0 ? count : -count)});
  }
}

}  // namespace

std::string arrangePlane(std::span<const PlaneTriangle> triangles, std::vector<ArrangedLine> lines,
                         std::vector<std::uint32_t> points, PointSet& all,
                         std::vector<ArrangedTriangle>& out, const Progress* progress) {
  PlaneArrangement plane(triangles, std::move(lines), std::move(points), all, progress);
  std::string failure = plane.triangulateAll();
  if (failure.empty()) plane.appendTriangles(out);
  return failure;
}

}  // namespace sherd
