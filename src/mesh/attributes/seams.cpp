// Finds seams, and where lines pass them.
#include "mesh/attributes/seams.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_set>

#include "base/infinity.h"
#include "mesh/attributes/bent_attributes.h"
#include "mesh/vertex_normals.h"

namespace sherd {
namespace {

// Smaller charts have no seams, square voxels.
constexpr double kLeastChart = 1.0;

// The share of the area on which attributes need not be linear.
constexpr double kMostBent = 0.01;

// A crossing is found to this many voxels.
constexpr double kPrecision = 2e-4;

// A seam turns where it deviates by 20 degrees.
const double kStraight = std::cos(20.0 * 3.14159265358979323846 / 180.0);

TriangleMesh inVoxels(const TriangleMesh& mesh, const glm::dvec3& origin, double voxelSize) {
  TriangleMesh out{mesh.vertices, mesh.triangles};
  for (glm::dvec3& v : out.vertices) v = (v - origin) / voxelSize;
  return out;
}

std::array<std::uint32_t, 2> endsOf(const TriangleMesh& mesh, const Charts::Seam& seam) {
  const glm::uvec3& t = mesh.triangles[seam.triangle[0]];
  return {t[seam.corner[0]], t[(seam.corner[0] + 1) % 3]};
}

// Lines or points as triangles without area.
TriangleTree degenerate(const TriangleMesh& mesh, const std::vector<Charts::Seam>& seams) {
  TriangleMesh lines;
  for (const Charts::Seam& seam : seams) {
    const auto first = static_cast<std::uint32_t>(lines.vertices.size());
    for (const std::uint32_t v : endsOf(mesh, seam)) lines.vertices.push_back(mesh.vertices[v]);
    lines.triangles.emplace_back(first, first + 1, first + 1);
  }
  return TriangleTree(lines);
}

}  // namespace

// A line between two points.
struct Seams::Line {
  glm::dvec3 begin{0.0}, end{0.0};

  [[nodiscard]] glm::dvec3 at(double t) const { return begin + t * (end - begin); }
  [[nodiscard]] double length() const { return glm::length(end - begin); }
};

// The side of a seam: a chart, or the part of it that is connected near a line.
struct Seams::Side {
  std::uint32_t chart = kNoTriangle;
  bool isPart = false;
  std::unordered_set<std::uint32_t> part{};
  const Seams* seams = nullptr;

  [[nodiscard]] bool has(std::uint32_t triangle) const {
    return seams->chart_[triangle] == chart && (!isPart || part.contains(triangle));
  }
};

std::vector<double> Seams::chartAreas(const TriangleMesh& mesh, const Charts& charts) {
  std::vector<double> areas(mesh.triangles.size(), 0.0);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    const glm::dvec3& a = mesh.vertices[t.x];
    areas[charts.ids[i]] +=
        0.5 * glm::length(glm::cross(mesh.vertices[t.y] - a, mesh.vertices[t.z] - a));
  }
  return areas;
}

Seams::Seams(const TriangleMesh& source, const glm::dvec3& origin, double voxelSize)
    : edges_(TriangleMesh()), corners_(TriangleMesh()), near_(TriangleMesh()) {
  if (source.attributes.hasOnlyNormals()) return;
  Charts charts = sherd::charts(source);
  double bent = bentArea(source, charts) / (voxelSize * voxelSize);
  if (charts.seams.empty()) {
    areLinear_ = bent <= kMostBent * area(source) / (voxelSize * voxelSize);
    return;
  }
  const TriangleMesh mesh = inVoxels(source, origin, voxelSize);
  const std::vector<double> areas = chartAreas(mesh, charts);
  for (std::size_t t = 0; t < areas.size(); ++t) {
    if (charts.ids[t] == t && areas[t] < kLeastChart) bent += areas[t];
  }
  areLinear_ = bent <= kMostBent * area(mesh);
  std::erase_if(charts.seams, [&](const Charts::Seam& seam) {
    return std::any_of(seam.triangle.begin(), seam.triangle.end(),
                       [&](std::uint32_t t) { return areas[charts.ids[t]] < kLeastChart; });
  });
  if (charts.seams.empty()) return;
  edges_ = degenerate(mesh, charts.seams);
  takeTriangles(mesh, charts, areas);
  takeCorners(mesh, charts.seams);
}

// Takes the triangles that may be the nearest one of a point near a seam: where the seam is d away,
// the nearest triangle is as near or nearer, so it is at most 2 d from the seam.
void Seams::takeTriangles(const TriangleMesh& mesh, const Charts& charts,
                          const std::vector<double>& areas) {
  const std::size_t count = mesh.triangles.size();
  std::vector<std::uint8_t> isNear(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const glm::uvec3& t = mesh.triangles[i];
    const std::array<glm::dvec3, 3> v{mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]};
    const glm::dvec3 middle = (v[0] + v[1] + v[2]) / 3.0;
    double radius = 0.0;
    for (const glm::dvec3& corner : v) radius = std::max(radius, glm::length(corner - middle));
    isNear[i] = edges_.nearest(middle, radius + 2.0 * kReach + 0.01).distance < kInfinity;
  });
  TriangleMesh near{mesh.vertices, {}};
  std::vector<std::uint32_t> of;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!isNear[i]) continue;
    near.triangles.push_back(mesh.triangles[i]);
    of.push_back(i);
  }
  near_ = TriangleTree(near);
  std::vector<bool> selfSeam(count, false);
  for (const std::uint32_t t : charts.selfSeam) selfSeam[charts.ids[t]] = true;
  std::vector<std::uint32_t> place(count, kNoTriangle);
  for (std::uint32_t i = 0; i < of.size(); ++i) {
    source_.push_back(of[near_.source(i)]);
    place[source_.back()] = i;
  }
  connected_.resize(of.size());
  beyond_.assign(of.size(), {kNoTriangle, kNoTriangle, kNoTriangle});
  for (std::size_t i = 0; i < of.size(); ++i) {
    const std::uint32_t chart = charts.ids[source_[i]];
    chart_.push_back(areas[chart] < kLeastChart ? kNoTriangle : chart);
    meetsItself_.push_back(selfSeam[chart]);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t next = charts.neighbors[source_[i]][k];
      connected_[i][k] = next == kNoTriangle ? kNoTriangle : place[next];
    }
  }
  for (const Charts::Seam& seam : charts.seams) {
    for (std::size_t k = 0; k < 2; ++k) {
      beyond_[place[seam.triangle[k]]][seam.corner[k]] = place[seam.triangle[1 - k]];
    }
  }
}

void Seams::takeCorners(const TriangleMesh& mesh, const std::vector<Charts::Seam>& seams) {
  struct End {
    std::uint32_t from, to;
    auto operator<=>(const End&) const = default;
  };
  std::vector<End> ends;
  for (const Charts::Seam& seam : seams) {
    const auto [a, b] = endsOf(mesh, seam);
    ends.push_back({a, b});
    ends.push_back({b, a});
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  TriangleMesh points;
  for (std::size_t i = 0, next = 0; i < ends.size(); i = next) {
    next = i + 1;
    while (next < ends.size() && ends[next].from == ends[i].from) ++next;
    if (next - i == 1) continue;  // the end of a seam
    const glm::dvec3& at = mesh.vertices[ends[i].from];
    const glm::dvec3 a = unitOrZero(mesh.vertices[ends[i].to] - at);
    const glm::dvec3 b = unitOrZero(mesh.vertices[ends[i + 1].to] - at);
    if (next - i == 2 && glm::dot(a, b) < -kStraight) continue;
    const auto v = static_cast<std::uint32_t>(points.vertices.size());
    points.vertices.push_back(at);
    points.triangles.emplace_back(v, v, v);
  }
  corners_ = TriangleTree(points);
}

std::optional<IndexPoint> Seams::cornerNear(const IndexPoint& point, double reach) const {
  const TriangleTree::Nearest found = corners_.nearest(point, reach);
  if (found.triangle == TriangleTree::kNone) return std::nullopt;
  return corners_.corners(found.triangle)[0];
}

Seams::Foot Seams::nearest(const IndexPoint& point) const {
  // Without a guess, which would decide between triangles at one distance.
  const std::uint32_t triangle = near_.nearest(point, kInfinity).triangle;
  if (triangle == TriangleTree::kNone) return {};
  const std::array<glm::dvec3, 3> v = near_.corners(triangle);
  Foot foot{triangle, nearestOnTriangle(point, v[0], v[1], v[2])};
  foot.triangle = betterOf(foot, point);
  return foot;
}

// Beyond a convex edge both its triangles are equally near: the one is meant whose plane is farther
// away, as the plane between them decides.
std::uint32_t Seams::betterOf(const Foot& foot, const IndexPoint& point) const {
  const auto height = [&](std::uint32_t triangle) {
    const std::array<glm::dvec3, 3> v = near_.corners(triangle);
    const glm::dvec3 normal = unitOrZero(glm::cross(v[1] - v[0], v[2] - v[0]));
    return std::abs(glm::dot(normal, point - foot.at));
  };
  const std::array<glm::dvec3, 3> v = near_.corners(foot.triangle);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t other = beyond_[foot.triangle][k];
    if (other == kNoTriangle) continue;
    const glm::dvec3 along = unitOrZero(v[(k + 1) % 3] - v[k]);
    if (glm::length(glm::cross(along, foot.at - v[k])) > 1e-9) continue;
    if (height(other) > height(foot.triangle)) return other;
  }
  return foot.triangle;
}

Seams::Side Seams::sideOf(const Foot& begin, const IndexPoint& middle, double reach) const {
  Side side{chart_[begin.triangle], meetsItself_[begin.triangle], {}, this};
  if (!side.isPart) return side;
  std::vector<std::uint32_t> found{begin.triangle};
  side.part.insert(begin.triangle);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const std::uint32_t next : connected_[found[i]]) {
      if (next == kNoTriangle || side.part.contains(next)) continue;
      if (near_.squaredTo(middle, next) > reach * reach) continue;
      side.part.insert(next);
      found.push_back(next);
    }
  }
  return side;
}

// The place where the line passes the plane half-way between two triangles on both sides of a seam,
// if it does so within the seam's edge.
std::optional<double> Seams::onEdge(const Line& line, double low, std::uint32_t lowIn, double high,
                                    std::uint32_t highIn) const {
  for (std::size_t k = 0; k < 3; ++k) {
    if (beyond_[lowIn][k] != highIn) continue;
    const std::array<glm::dvec3, 3> a = near_.corners(lowIn), b = near_.corners(highIn);
    const glm::dvec3& from = a[k];
    const glm::dvec3& to = a[(k + 1) % 3];
    const glm::dvec3 along = unitOrZero(to - from);
    // Directions from the edge into each triangle.
    const auto into = [&](const std::array<glm::dvec3, 3>& t) {
      const glm::dvec3 middle = (t[0] + t[1] + t[2]) / 3.0 - from;
      return unitOrZero(middle - glm::dot(middle, along) * along);
    };
    const glm::dvec3 across = into(a) - into(b);
    const double before = glm::dot(line.at(low) - from, across);
    const double after = glm::dot(line.at(high) - from, across);
    if (!(before > 0.0 && after < 0.0)) return std::nullopt;
    const double t = low + (high - low) * before / (before - after);
    const double place = glm::dot(line.at(t) - from, along);
    if (!(place >= 0.0 && place <= glm::length(to - from))) return std::nullopt;
    return t;
  }
  return std::nullopt;
}

double Seams::between(const Line& line, const Side& side, double low, std::uint32_t lowIn,
                      double high, std::uint32_t highIn) const {
  while (true) {
    if (const auto found = onEdge(line, low, lowIn, high, highIn)) return *found;
    const double middle = 0.5 * (low + high);
    if ((high - low) * line.length() < kPrecision) return middle;
    const std::uint32_t in = nearest(line.at(middle)).triangle;
    if (side.has(in)) {
      low = middle;
      lowIn = in;
    } else {
      high = middle;
      highIn = in;
    }
  }
}

std::optional<double> Seams::crossing(const IndexPoint& begin, const IndexPoint& end) const {
  const Line line{begin, end};
  const double length = line.length();
  if (!(length > 3.0 * kOnSeam)) return std::nullopt;
  const double low = kOnSeam / length, high = 1.0 - low;
  const glm::dvec3 from = line.at(low), to = line.at(high);
  const auto isOnSeam = [&](const glm::dvec3& point) {
    return edges_.nearest(point, 0.5 * kOnSeam).distance < kInfinity;
  };
  if (isOnSeam(from) && isOnSeam(to)) return std::nullopt;  // whose ends are on no side
  const Foot first = nearest(from), last = nearest(to);
  if (first.triangle == kNoTriangle || first.triangle == last.triangle) return std::nullopt;
  if (chart_[first.triangle] == kNoTriangle || chart_[last.triangle] == kNoTriangle) {
    return std::nullopt;
  }
  const double aside = std::max(glm::length(first.at - from), glm::length(last.at - to));
  const Side side = sideOf(first, line.at(0.5), 0.5 * length + aside);
  if (side.has(last.triangle)) return std::nullopt;
  const double t = between(line, side, low, first.triangle, high, last.triangle);
  if (!(edges_.nearest(line.at(t), kAside).distance < kInfinity)) return std::nullopt;
  return t;
}

}  // namespace sherd
