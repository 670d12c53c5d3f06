// A tree of triangles for nearest distances, winding numbers and rays.
#include "mesh/search/triangle_tree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <utility>

#include "base/infinity.h"
#include "mesh/search/boxes.h"
#include "mesh/search/solid_angles.h"
#include "mesh/vertex_normals.h"

namespace sherd {
namespace {

constexpr std::size_t kLeafTriangles = 4;  // at most

// Ranges of fewer triangles are processed by one thread.
constexpr std::size_t kMinParallel = 8192;

float below(double v) { return std::nextafter(static_cast<float>(v), -INFINITY); }
float above(double v) { return std::nextafter(static_cast<float>(v), INFINITY); }

// Four numbers, for bounds of distances.
using Floats = float __attribute__((vector_size(16)));

Floats load(const glm::vec4& v) { return Floats{v.x, v.y, v.z, v.w}; }
Floats larger(Floats a, Floats b) { return a > b ? a : b; }

constexpr float kRoundedDown = 1.0f - 1e-6f;  // exceeds the effect of a few roundings

// A point, enclosed by its two neighbors in single precision.
class Near {
 public:
  explicit Near(const glm::dvec3& p)
      : low_{below(p.x), below(p.y), below(p.z), 0.0f},
        high_{above(p.x), above(p.y), above(p.z), 0.0f} {}

  // Returns a lower bound of the squared distance to a box.
  [[nodiscard]] float squaredTo(const glm::vec4& min, const glm::vec4& max) const {
    const Floats outside = larger(larger(load(min) - high_, low_ - load(max)), Floats{});
    const Floats squares = outside * outside;
    return (squares[0] + squares[1] + squares[2]) * kRoundedDown;
  }

 private:
  Floats low_, high_;
};

// A box, enclosed by one in single precision.
class Around {
 public:
  explicit Around(const Box& box)
      : low_{below(box.min.x), below(box.min.y), below(box.min.z), 0.0f},
        high_{above(box.max.x), above(box.max.y), above(box.max.z), 0.0f} {}

  // Whether it has a point in common with another.
  [[nodiscard]] bool meets(const glm::vec4& min, const glm::vec4& max) const {
    const auto isApart = (load(min) > high_) | (load(max) < low_);
    return ((isApart[0] | isApart[1]) | isApart[2]) == 0;
  }

 private:
  Floats low_, high_;
};

// A ray that misses a box by this fraction of its length counts as a hit, so that rounding loses no
// triangle; oriented boxes are wider by this fraction of their distance from the origin.
constexpr double kRounding = 1e-9;

// Returns where a ray entryDistance a box, or infinity.
double entryDistance(const glm::vec4& min, const glm::vec4& max, const glm::dvec3& origin,
                     const glm::dvec3& inverse) {
  double from = 0.0, to = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (static_cast<double>(min[axis]) - origin[axis]) * inverse[axis];
    const double b = (static_cast<double>(max[axis]) - origin[axis]) * inverse[axis];
    // NaN (0 * infinity) occurs only on a face of a box, which is rounded outwards: no triangle
    // is there.
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to + kRounding ? from : kInfinity;
}

//   margin  hits beside an edge that count, as a share of the triangle's size
//   source  Moeller, Trumbore: Fast, Minimum Storage Ray/Triangle Intersection, 1997
double rayHit(const std::array<glm::dvec3, 3>& t, const glm::dvec3& origin,
              const glm::dvec3& direction, double margin = 0.0) {
  const glm::dvec3 e1 = t[1] - t[0], e2 = t[2] - t[0], p = glm::cross(direction, e2);
  const double determinant = glm::dot(e1, p);
  if (determinant == 0.0) return kInfinity;
  const glm::dvec3 s = origin - t[0];
  const double u = glm::dot(s, p) / determinant;
  if (!(u >= -margin && u <= 1.0 + margin)) return kInfinity;
  const glm::dvec3 q = glm::cross(s, e1);
  const double v = glm::dot(direction, q) / determinant;
  if (!(v >= -margin && u + v <= 1.0 + margin)) return kInfinity;
  return glm::dot(e2, q) / determinant;
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) : TriangleTree(mesh, false) {}

TriangleTree TriangleTree::ofStrip(const TriangleMesh& strip) {
  TriangleTree tree(strip, true);
  tree.addOrientedBoxes();
  return tree;
}

TriangleTree::TriangleTree(const TriangleMesh& mesh, bool isSorted) {
  const std::size_t count = mesh.triangles.size();
  if (count == 0) return;
  while ((count + (std::size_t{1} << levels_) - 1) >> levels_ > kLeafTriangles) ++levels_;
  std::vector<Item> items(count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    items[i] = {glm::vec3(mesh.vertices[t.x] + mesh.vertices[t.y] + mesh.vertices[t.z]),
                static_cast<std::uint32_t>(i)};
  }
  if (!isSorted) sortInto(items, {0, 0, count, levels_});
  // Vertices are stored in the order of the leaves, so that near ones are near in memory.
  std::vector<std::uint32_t> number(mesh.vertices.size(), kNone);
  vertices_.reserve(mesh.vertices.size());
  triangles_.reserve(count);
  source_.reserve(count);
  for (const Item& item : items) {
    glm::uvec3 triangle = mesh.triangles[item.triangle];
    for (int corner = 0; corner < 3; ++corner) {
      std::uint32_t& vertex = number[triangle[corner]];
      if (vertex == kNone) {
        vertex = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back(mesh.vertices[triangle[corner]]);
      }
      triangle[corner] = vertex;
    }
    triangles_.push_back(triangle);
    source_.push_back(item.triangle);
  }
  first_.assign((std::size_t{1} << levels_) + 1, static_cast<std::uint32_t>(count));
  bounds_.resize((std::size_t{2} << levels_) - 1);
  dipoles_.resize(bounds_.size());
  measure(root());
}

// Splits at the median of the box's longest axis, down to the leaves.
void TriangleTree::sortInto(std::span<Item> items, const Range& range) {
  if (range.isLeaf()) return;
  glm::vec3 min(kInfinity), max(-kInfinity);
  for (std::size_t i = range.begin; i < range.end; ++i) {
    min = glm::min(min, items[i].center);
    max = glm::max(max, items[i].center);
  }
  const glm::vec3 size = max - min;
  const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  const Range first = range.child(0), second = range.child(1);
  const auto at = [&](std::size_t i) { return items.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(range.begin), at(second.begin), at(range.end),
                   [axis](const Item& a, const Item& b) {
                     const float x = a.center[axis], y = b.center[axis];
                     return x != y ? x < y : a.triangle < b.triangle;
                   });
  if (range.end - range.begin < kMinParallel) {
    sortInto(items, first);
    sortInto(items, second);
  } else {
    tbb::parallel_invoke([&] { sortInto(items, first); }, [&] { sortInto(items, second); });
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
      dipole.center += area / 3.0 * (t[0] + t[1] + t[2]);
    }
    box = {{below(min.x), below(min.y), below(min.z), 0.0f},
           {above(max.x), above(max.y), above(max.z), 0.0f}};
    first_[range.node - firstLeaf()] = static_cast<std::uint32_t>(range.begin);
  } else {
    const Range first = range.child(0), second = range.child(1);
    if (range.end - range.begin < kMinParallel) {
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
      dipole.center += part.area * part.center;
    }
  }
  const glm::dvec3 min(box.min), max(box.max);
  dipole.center = dipole.area > 0.0 ? dipole.center / dipole.area : 0.5 * (min + max);
  if (range.isLeaf()) {
    for (std::size_t i = range.begin; i < range.end; ++i) {
      for (const glm::dvec3& v : corners(i)) {
        dipole.radius = std::max(dipole.radius, glm::length(v - dipole.center));
      }
    }
  } else {
    dipole.radius = glm::length(glm::max(max - dipole.center, dipole.center - min));
    double within = 0.0;
    for (const Range& child : {range.child(0), range.child(1)}) {
      const Dipole& part = dipoles_[child.node];
      within = std::max(within, glm::length(part.center - dipole.center) + part.radius);
    }
    dipole.radius = std::min(dipole.radius, within);
  }
}

TriangleTree::OrientedBox TriangleTree::orientedBox(const Range& range) const {
  OrientedBox box;
  glm::dvec3 longest(0.0);
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const std::array<glm::dvec3, 3> t = corners(i);
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 edge = t[(k + 1) % 3] - t[k];
      if (glm::dot(edge, edge) > glm::dot(longest, longest)) longest = edge;
    }
  }
  box.axis[0] = unitOrZero(dipoles_[range.node].normal);
  box.axis[1] = unitOrZero(longest - glm::dot(longest, box.axis[0]) * box.axis[0]);
  box.axis[2] = unitOrZero(glm::cross(box.axis[0], box.axis[1]));
  box.least = glm::dvec3(kInfinity), box.most = glm::dvec3(-kInfinity);
  for (std::size_t i = range.begin; i < range.end; ++i) {
    for (const glm::dvec3& v : corners(i)) {
      const glm::dvec3 at(glm::dot(box.axis[0], v), glm::dot(box.axis[1], v),
                          glm::dot(box.axis[2], v));
      box.least = glm::min(box.least, at), box.most = glm::max(box.most, at);
    }
  }
  const glm::dvec3 min(bounds_[0].min), max(bounds_[0].max);
  const double slack = kRounding * std::max(glm::length(min), glm::length(max));
  box.least -= slack, box.most += slack;
  return box;
}

double TriangleTree::OrientedBox::squaredTo(const glm::dvec3& point, double slack) const {
  double squared = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double at = glm::dot(axis[static_cast<std::size_t>(k)], point);
    const double outside = std::max(std::max(least[k] - at, at - most[k]) - slack, 0.0);
    squared += outside * outside;
  }
  return squared;
}

void TriangleTree::addOrientedBoxes() {
  if (empty()) return;
  oriented_.resize(bounds_.size());
  walk(
      [&](const Range& range) {
        oriented_[range.node] = orientedBox(range);
        return false;
      },
      [](std::size_t) {});
}

TriangleTree::Nearest TriangleTree::nearest(const glm::dvec3& point, double reach,
                                            std::uint32_t guess) const {
  if (empty()) return {};
  const Near near(point);
  // Not infinite: a tree that is very far away has a nearest triangle too.
  constexpr float kFarthest = std::numeric_limits<float>::max();
  const auto toBox = [&](std::size_t node) {
    return std::min(near.squaredTo(bounds_[node].min, bounds_[node].max), kFarthest);
  };
  if (oriented_.empty()) return nearestBy(toBox, point, reach, guess);
  const double slack = kRounding * glm::length(point);
  const auto toBoth = [&](std::size_t node) {
    const double squared = oriented_[node].squaredTo(point, slack);
    return static_cast<float>(std::min<double>(squared, kFarthest)) * kRoundedDown;
  };
  return nearestBy(toBoth, point, reach, guess);
}

template <class SquaredTo>
TriangleTree::Nearest TriangleTree::nearestBy(const SquaredTo& squaredTo, const glm::dvec3& point,
                                              double reach, std::uint32_t guess) const {
  Nearest found;
  double squared = reach * reach;
  const auto test = [&](std::size_t triangle) {
    const double d = this->squaredTo(point, triangle);
    if (!(d < squared)) return;
    squared = d;
    found = {std::sqrt(d), static_cast<std::uint32_t>(triangle)};
  };
  if (guess != kNone) test(guess);

  struct Waiting {
    std::size_t node;
    float squared;
  };
  std::array<Waiting, kDeepest> stack;
  std::size_t waiting = 0;
  std::size_t node = 0;
  float here = squaredTo(0);
  while (true) {
    if (static_cast<double>(here) < squared) {
      if (node < firstLeaf()) {
        std::size_t closer = 2 * node + 1, farther = closer + 1;
        float a = squaredTo(closer), b = squaredTo(farther);
        if (b < a) std::swap(closer, farther), std::swap(a, b);
        if (static_cast<double>(b) < squared) stack[waiting++] = {farther, b};
        node = closer;
        here = a;
        continue;
      }
      const std::size_t leaf = node - firstLeaf();
      for (std::size_t i = first_[leaf]; i < first_[leaf + 1]; ++i) test(i);
    }
    if (waiting == 0) return found;
    node = stack[--waiting].node;
    here = stack[waiting].squared;
  }
}

double TriangleTree::winding(const glm::dvec3& point) const {
  if (empty()) return 0.0;
  SolidAngles near;
  const double far = addSolidAngles(root(), point, near);
  return (far + near.sum()) / (4.0 * std::numbers::pi);
}

double TriangleTree::addSolidAngles(const Range& from, const glm::dvec3& point,
                                    SolidAngles& near) const {
  double angle = 0.0;
  walk(
      from,
      [&](const Range& range) {
        const Dipole& dipole = dipoles_[range.node];
        const glm::dvec3 apart = dipole.center - point;
        const double squared = glm::dot(apart, apart), far = kFarRadii * dipole.radius;
        if (!(squared > far * far)) return false;
        angle += glm::dot(dipole.normal, apart) / (squared * std::sqrt(squared));
        return true;
      },
      [&](std::size_t triangle) { near.add(corners(triangle), point); });
  return angle;
}

// Returns 1 if the step enters through the triangle's front, -1 if it leaves through its back, else
// 0.
int TriangleTree::entry(const glm::dvec3& from, const glm::dvec3& to, std::size_t triangle) const {
  const glm::uvec3& t = triangles_[triangle];
  const glm::dvec3 &a = vertices_[t.x], normal = glm::cross(vertices_[t.y] - a, vertices_[t.z] - a);
  const bool before = glm::dot(normal, from - a) > 0.0, after = glm::dot(normal, to - a) > 0.0;
  if (before == after) return 0;
  const glm::dvec3 along = to - from;
  // The side of an edge that the step passes on.  The edge is directed by vertex index, so that
  // both of its triangles get the same result.
  const auto passes = [&](std::uint32_t p, std::uint32_t q) {
    const bool swapped = q < p;
    if (swapped) std::swap(p, q);
    const bool left = glm::dot(along, glm::cross(vertices_[p] - from, vertices_[q] - from)) > 0.0;
    return left != swapped;
  };
  const bool side = passes(t.x, t.y);
  if (passes(t.y, t.z) != side || passes(t.z, t.x) != side) return 0;
  return before ? 1 : -1;
}

int TriangleTree::entries(const glm::dvec3& from, const glm::dvec3& to,
                          std::span<const std::uint32_t> triangles) const {
  int entered = 0;
  for (const std::uint32_t triangle : triangles) entered += entry(from, to, triangle);
  return entered;
}

int TriangleTree::entries(const glm::dvec3& from, const glm::dvec3& to) const {
  int entered = 0;
  const glm::dvec3 inverse = 1.0 / (to - from);
  walk(
      [&](const Range& range) {
        const Bounds& box = bounds_[range.node];
        return !(entryDistance(box.min, box.max, from, inverse) <= 1.0 + kRounding);
      },
      [&](std::size_t triangle) { entered += entry(from, to, triangle); });
  return entered;
}

void TriangleTree::findMeeting(const Box& box, std::vector<std::uint32_t>& found) const {
  found.clear();
  const Around around(box);
  walk(
      [&](const Range& range) {
        const Bounds& bounds = bounds_[range.node];
        return !around.meets(bounds.min, bounds.max);
      },
      [&](std::size_t triangle) {
        if (!meet(boxOf(corners(triangle)), box)) return;
        found.push_back(static_cast<std::uint32_t>(triangle));
      });
}

std::vector<std::uint32_t> TriangleTree::meeting(const Box& box) const {
  std::vector<std::uint32_t> found;
  findMeeting(box, found);
  return found;
}

bool TriangleTree::isAnyMeeting(const Box& box) const {
  const Around around(box);
  bool isAny = false;
  walk(
      [&](const Range& range) {
        const Bounds& bounds = bounds_[range.node];
        return isAny || !around.meets(bounds.min, bounds.max);
      },
      [&](std::size_t triangle) { isAny = isAny || meet(boxOf(corners(triangle)), box); });
  return isAny;
}

double TriangleTree::firstHit(const glm::dvec3& origin, const glm::dvec3& direction,
                              double from) const {
  double first = kInfinity;
  const glm::dvec3 inverse = 1.0 / direction;
  walk(
      [&](const Range& range) {
        const Bounds& box = bounds_[range.node];
        return !(entryDistance(box.min, box.max, origin, inverse) < first);
      },
      [&](std::size_t triangle) {
        const double distance = rayHit(corners(triangle), origin, direction);
        if (distance > from && distance < first) first = distance;
      });
  return first;
}

// Sets the first hit of a segment if a triangle has it.
void TriangleTree::hit(const glm::dvec3& from, const glm::dvec3& along, std::size_t triangle,
                       Hit& first) const {
  const double at = rayHit(corners(triangle), from, along, kRounding);
  if (!(at >= -kRounding && at <= first.at + kRounding)) return;
  const bool isFirst = first.triangle == kNone || at < first.at ||
                       (at == first.at && source_[triangle] < source_[first.triangle]);
  if (isFirst) first = {at, static_cast<std::uint32_t>(triangle)};
}

std::optional<TriangleTree::Hit> TriangleTree::firstBetween(const glm::dvec3& from,
                                                            const glm::dvec3& to) const {
  Hit first{1.0, kNone};
  const glm::dvec3 along = to - from, inverse = 1.0 / along;
  walk(
      [&](const Range& range) {
        const Bounds& box = bounds_[range.node];
        return !(entryDistance(box.min, box.max, from, inverse) <= first.at + kRounding);
      },
      [&](std::size_t triangle) { hit(from, along, triangle, first); });
  return clamped(first);
}

std::optional<TriangleTree::Hit> TriangleTree::firstBetween(
    const glm::dvec3& from, const glm::dvec3& to, std::span<const std::uint32_t> triangles) const {
  Hit first{1.0, kNone};
  for (const std::uint32_t triangle : triangles) hit(from, to - from, triangle, first);
  return clamped(first);
}

std::optional<TriangleTree::Hit> TriangleTree::clamped(const Hit& hit) {
  if (hit.triangle == kNone) return std::nullopt;
  return Hit{std::clamp(hit.at, 0.0, 1.0), hit.triangle};
}

}  // namespace sherd
