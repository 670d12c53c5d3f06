// A tree of triangles.
#include "mesh/triangle_tree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>
#include <utility>

#include "mesh/nearest_on_triangle.h"
#include "mesh/solid_angles.h"

namespace sherd {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kLeafTriangles = 4;  // at most

// Groups farther away than this many of their radii are dipoles.
constexpr double kFarRadii = 2.5;

// Halves of fewer triangles are not worth a thread.
constexpr std::size_t kForAThread = 8192;

// A walk keeps one node a level; 2^32 triangles make 30 levels.
constexpr std::size_t kDeepest = 64;

float below(double v) { return std::nextafter(static_cast<float>(v), -INFINITY); }
float above(double v) { return std::nextafter(static_cast<float>(v), INFINITY); }

double squaredDistance(const glm::vec3& min, const glm::vec3& max, const glm::dvec3& p) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double outside = std::max(
        {static_cast<double>(min[axis]) - p[axis], p[axis] - static_cast<double>(max[axis]), 0.0});
    sum += outside * outside;
  }
  return sum;
}

// Where a ray enters a box, or infinity.
double entry(const glm::vec3& min, const glm::vec3& max, const glm::dvec3& origin,
             const glm::dvec3& inverse) {
  double from = 0.0, to = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (static_cast<double>(min[axis]) - origin[axis]) * inverse[axis];
    const double b = (static_cast<double>(max[axis]) - origin[axis]) * inverse[axis];
    from = std::fmax(from, std::fmin(a, b));  // 0 * infinity bounds nothing
    to = std::fmin(to, std::fmax(a, b));
  }
  return from <= to ? from : kInfinity;
}

// source  Moeller, Trumbore: Fast, Minimum Storage Ray/Triangle Intersection, 1997
double rayHit(const std::array<glm::dvec3, 3>& t, const glm::dvec3& origin,
              const glm::dvec3& direction) {
  const glm::dvec3 e1 = t[1] - t[0], e2 = t[2] - t[0], p = glm::cross(direction, e2);
  const double determinant = glm::dot(e1, p);
  if (determinant == 0.0) return kInfinity;
  const glm::dvec3 s = origin - t[0];
  const double u = glm::dot(s, p) / determinant;
  if (!(u >= 0.0 && u <= 1.0)) return kInfinity;
  const glm::dvec3 q = glm::cross(s, e1);
  const double v = glm::dot(direction, q) / determinant;
  if (!(v >= 0.0 && u + v <= 1.0)) return kInfinity;
  return glm::dot(e2, q) / determinant;
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) : vertices_(mesh.vertices) {
  const std::size_t count = mesh.triangles.size();
  if (count == 0) return;
  while ((count + (std::size_t{1} << levels_) - 1) >> levels_ > kLeafTriangles) ++levels_;
  std::vector<glm::dvec3> middles;
  middles.reserve(count);
  for (const glm::uvec3& t : mesh.triangles) {
    middles.push_back(vertices_[t.x] + vertices_[t.y] + vertices_[t.z]);
  }
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  triangles_.resize(count);
  sortInto(middles, order, root());
  for (std::size_t i = 0; i < count; ++i) triangles_[i] = mesh.triangles[order[i]];
  bounds_.resize((std::size_t{2} << levels_) - 1);
  dipoles_.resize(bounds_.size());
  measure(root());
}

// Halve at the median of the box's longest axis, down to the leaves.
void TriangleTree::sortInto(std::span<const glm::dvec3> middles, std::vector<std::uint32_t>& order,
                            const Range& range) const {
  if (range.isLeaf()) return;
  const auto at = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
  glm::dvec3 min(kInfinity), max(-kInfinity);
  for (std::size_t i = range.begin; i < range.end; ++i) {
    min = glm::min(min, middles[order[i]]);
    max = glm::max(max, middles[order[i]]);
  }
  const glm::dvec3 size = max - min;
  const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  const Range first = range.child(0), second = range.child(1);
  std::nth_element(at(range.begin), at(second.begin), at(range.end),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double x = middles[a][axis], y = middles[b][axis];
                     return x != y ? x < y : a < b;
                   });
  if (range.end - range.begin < kForAThread) {
    sortInto(middles, order, first);
    sortInto(middles, order, second);
  } else {
    tbb::parallel_invoke([&] { sortInto(middles, order, first); },
                         [&] { sortInto(middles, order, second); });
  }
}

void TriangleTree::measure(const Range& range) {
  Dipole& dipole = dipoles_[range.node];
  Bounds& box = bounds_[range.node];
  if (range.isLeaf()) {
    glm::dvec3 min(kInfinity), max(-kInfinity);
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const std::array<glm::dvec3, 3> t = corners(i);
      for (const glm::dvec3& v : t) min = glm::min(min, v), max = glm::max(max, v);
      const glm::dvec3 normal = 0.5 * glm::cross(t[1] - t[0], t[2] - t[0]);
      const double area = glm::length(normal);
      dipole.normal += normal;
      dipole.area += area;
      dipole.centre += area / 3.0 * (t[0] + t[1] + t[2]);
    }
    box = {{below(min.x), below(min.y), below(min.z)}, {above(max.x), above(max.y), above(max.z)}};
  } else {
    const Range first = range.child(0), second = range.child(1);
    if (range.end - range.begin < kForAThread) {
      measure(first);
      measure(second);
    } else {
      tbb::parallel_invoke([&] { measure(first); }, [&] { measure(second); });
    }
    const Bounds &a = bounds_[first.node], &b = bounds_[second.node];
    box = {glm::min(a.min, b.min), glm::max(a.max, b.max)};
    for (const Range& child : {first, second}) {
      const Dipole& part = dipoles_[child.node];
      dipole.normal += part.normal;
      dipole.area += part.area;
      dipole.centre += part.area * part.centre;
    }
  }
  const glm::dvec3 min(box.min), max(box.max);
  dipole.centre = dipole.area > 0.0 ? dipole.centre / dipole.area : 0.5 * (min + max);
  if (range.isLeaf()) {
    for (std::size_t i = range.begin; i < range.end; ++i) {
      for (const glm::dvec3& v : corners(i)) {
        dipole.radius = std::max(dipole.radius, glm::length(v - dipole.centre));
      }
    }
  } else {
    dipole.radius = glm::length(glm::max(max - dipole.centre, dipole.centre - min));
    double within = 0.0;
    for (const Range& child : {range.child(0), range.child(1)}) {
      const Dipole& part = dipoles_[child.node];
      within = std::max(within, glm::length(part.centre - dipole.centre) + part.radius);
    }
    dipole.radius = std::min(dipole.radius, within);
  }
}

TriangleTree::Nearest TriangleTree::nearest(const glm::dvec3& point, double reach,
                                            std::uint32_t guess) const {
  Nearest found;
  if (triangles_.empty()) return found;
  double squared = reach * reach;
  const auto look = [&](std::size_t triangle) {
    const std::array<glm::dvec3, 3> t = corners(triangle);
    const glm::dvec3 apart = point - nearestOnTriangle(point, t[0], t[1], t[2]);
    const double d = glm::dot(apart, apart);
    if (!(d < squared)) return;
    squared = d;
    found = {std::sqrt(d), static_cast<std::uint32_t>(triangle)};
  };
  if (guess != kNone) look(guess);

  struct Waiting {
    Range range;
    double squared;
  };
  std::array<Waiting, kDeepest> stack;
  std::size_t waiting = 0;
  Range range = root();
  double here = squaredDistance(bounds_[0].min, bounds_[0].max, point);
  while (true) {
    if (here < squared) {
      if (!range.isLeaf()) {
        Range near = range.child(0), far = range.child(1);
        double a = squaredDistance(bounds_[near.node].min, bounds_[near.node].max, point);
        double b = squaredDistance(bounds_[far.node].min, bounds_[far.node].max, point);
        if (b < a) std::swap(near, far), std::swap(a, b);
        if (b < squared) stack[waiting++] = {far, b};
        range = near;
        here = a;
        continue;
      }
      for (std::size_t i = range.begin; i < range.end; ++i) look(i);
    }
    if (waiting == 0) return found;
    range = stack[--waiting].range;
    here = stack[waiting].squared;
  }
}

double TriangleTree::winding(const glm::dvec3& point) const {
  if (triangles_.empty()) return 0.0;
  double angle = 0.0;
  SolidAngles near;
  std::array<Range, kDeepest> stack;
  std::size_t waiting = 0;
  stack[waiting++] = root();
  while (waiting > 0) {
    const Range range = stack[--waiting];
    const Dipole& dipole = dipoles_[range.node];
    const glm::dvec3 apart = dipole.centre - point;
    const double squared = glm::dot(apart, apart), far = kFarRadii * dipole.radius;
    if (squared > far * far) {
      angle += glm::dot(dipole.normal, apart) / (squared * std::sqrt(squared));
    } else if (range.isLeaf()) {
      for (std::size_t i = range.begin; i < range.end; ++i) near.add(corners(i), point);
    } else {
      stack[waiting++] = range.child(1);
      stack[waiting++] = range.child(0);
    }
  }
  return (angle + near.sum()) / (4.0 * std::numbers::pi);
}

int TriangleTree::entries(const glm::dvec3& from, const glm::dvec3& to) const {
  int entered = 0;
  if (triangles_.empty()) return entered;
  const glm::dvec3 along = to - from, min = glm::min(from, to), max = glm::max(from, to);
  const auto isBeside = [&](const Bounds& box) {
    return box.min.x > max.x || box.min.y > max.y || box.min.z > max.z || box.max.x < min.x ||
           box.max.y < min.y || box.max.z < min.z;
  };
  // On which side of an edge the step passes; neighbours see the edge from the same end.
  const auto passes = [&](std::uint32_t a, std::uint32_t b) {
    const bool swapped = b < a;
    if (swapped) std::swap(a, b);
    const bool left = glm::dot(along, glm::cross(vertices_[a] - from, vertices_[b] - from)) > 0.0;
    return left != swapped;
  };
  std::array<Range, kDeepest> stack;
  std::size_t waiting = 0;
  stack[waiting++] = root();
  while (waiting > 0) {
    const Range range = stack[--waiting];
    if (isBeside(bounds_[range.node])) continue;
    if (!range.isLeaf()) {
      stack[waiting++] = range.child(1);
      stack[waiting++] = range.child(0);
      continue;
    }
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const glm::uvec3& t = triangles_[i];
      const glm::dvec3 &a = vertices_[t.x],
                       normal = glm::cross(vertices_[t.y] - a, vertices_[t.z] - a);
      const bool before = glm::dot(normal, from - a) > 0.0, after = glm::dot(normal, to - a) > 0.0;
      if (before == after) continue;
      const bool side = passes(t.x, t.y);
      if (passes(t.y, t.z) != side || passes(t.z, t.x) != side) continue;
      entered += before ? 1 : -1;
    }
  }
  return entered;
}

double TriangleTree::firstHit(const glm::dvec3& origin, const glm::dvec3& direction,
                              double from) const {
  double first = kInfinity;
  if (triangles_.empty()) return first;
  const glm::dvec3 inverse = 1.0 / direction;
  std::array<Range, kDeepest> stack;
  std::size_t waiting = 0;
  stack[waiting++] = root();
  while (waiting > 0) {
    const Range range = stack[--waiting];
    if (!(entry(bounds_[range.node].min, bounds_[range.node].max, origin, inverse) < first)) {
      continue;
    }
    if (!range.isLeaf()) {
      stack[waiting++] = range.child(1);
      stack[waiting++] = range.child(0);
      continue;
    }
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const double distance = rayHit(corners(i), origin, direction);
      if (distance > from && distance < first) first = distance;
    }
  }
  return first;
}

}  // namespace sherd
