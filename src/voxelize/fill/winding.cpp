// Winding numbers by exact scan conversion.
#include "voxelize/fill/winding.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "base/cancel_flag.h"

namespace sherd {
namespace {

// Bits of the difference between two snapped coordinates: a sum of two products stays below 2^62.
constexpr int kBits = 30;

constexpr std::size_t kTrianglesPerCancelCheck = 1024;

struct Snapped {
  std::int64_t x, y;
  double z;
};

Snapped snapped(const glm::dvec3& p, int bits) {
  return {std::llround(std::ldexp(p.x, bits)), std::llround(std::ldexp(p.y, bits)), p.z};
}

// Returns twice the signed area of (a, b, p) viewed along -z.
std::int64_t side(const Snapped& a, const Snapped& b, std::int64_t px, std::int64_t py) {
  return (b.x - a.x) * (py - a.y) - (b.y - a.y) * (px - a.x);
}

// Whether a point on the edge a -> b counts as on its left: true for one of the two directions of
// every edge.
bool ownsItsPoints(const Snapped& a, const Snapped& b) {
  return b.y < a.y || (b.y == a.y && b.x > a.x);
}

// Calls hit(x, y, z, up) for each column that passes the triangle; `up` is +1 where the ray enters
// the solid, else -1.
template <class Hit>
void scan(std::array<Snapped, 3> t, int bits, Hit&& hit) {
  const std::int64_t one = std::int64_t{1} << bits;
  std::int64_t doubleArea = side(t[0], t[1], t[2].x, t[2].y);
  if (doubleArea == 0) return;  // parallel to the columns
  const int up = doubleArea > 0 ? -1 : 1;
  if (doubleArea < 0) {
    std::swap(t[1], t[2]);
    doubleArea = -doubleArea;
  }
  const auto [x0, x1] = std::minmax({t[0].x, t[1].x, t[2].x});
  const auto [y0, y1] = std::minmax({t[0].y, t[1].y, t[2].y});
  const std::array<std::int64_t, 3> bias{ownsItsPoints(t[1], t[2]) ? 0 : 1,
                                         ownsItsPoints(t[2], t[0]) ? 0 : 1,
                                         ownsItsPoints(t[0], t[1]) ? 0 : 1};
  for (std::int64_t x = (x0 + one - 1) >> bits; x <= x1 >> bits; ++x) {
    for (std::int64_t y = (y0 + one - 1) >> bits; y <= y1 >> bits; ++y) {
      const std::int64_t px = x * one, py = y * one;
      const std::int64_t a = side(t[1], t[2], px, py), b = side(t[2], t[0], px, py),
                         c = side(t[0], t[1], px, py);
      if (a < bias[0] || b < bias[1] || c < bias[2]) continue;
      const double z = (static_cast<double>(a) * t[0].z + static_cast<double>(b) * t[1].z +
                        static_cast<double>(c) * t[2].z) /
                       static_cast<double>(doubleArea);
      hit(static_cast<int>(x), static_cast<int>(y),
          static_cast<std::int32_t>(std::ceil(z - Winding::kTieAlongZ)), up);
    }
  }
}

}  // namespace

int Winding::latticeBits(const Box& box) {
  const glm::dvec3 size = box.max - box.min;
  const double longest = std::max({size.x, size.y, size.z}) + 4.0;
  return std::clamp(kBits - static_cast<int>(std::ceil(std::log2(longest))), 0, 24);
}

Winding::Winding(const TriangleMesh& mesh, Rule rule, const Progress* progress) {
  const Box box = bounds(mesh);
  for (int axis = 0; axis < 3; ++axis) {
    box_.min[axis] = static_cast<int>(std::floor(box.min[axis])) - 1;
    box_.max[axis] = static_cast<int>(std::ceil(box.max[axis])) + 1;
  }
  const auto ny = static_cast<std::size_t>(box_.dims().y());
  const std::size_t columns = static_cast<std::size_t>(box_.dims().x()) * ny;
  std::vector<Snapped> points(mesh.vertices.size());
  const int bits = latticeBits(box);
  std::transform(mesh.vertices.begin(), mesh.vertices.end(), points.begin(),
                 [&](const glm::dvec3& p) { return snapped(p, bits); });
  const auto column = [&](int x, int y) {
    return static_cast<std::size_t>(x - box_.min.x()) * ny +
           static_cast<std::size_t>(y - box_.min.y());
  };
  const auto eachHit = [&](auto&& hit) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      if (i % kTrianglesPerCancelCheck == 0) throwIfCancelled(progress);
      const glm::uvec3& t = mesh.triangles[i];
      scan({points[t.x], points[t.y], points[t.z]}, bits, hit);
    }
  };

  // Two passes, count and fill, group the changes by column without sorting all of them.
  first_.assign(columns + 1, 0);
  eachHit([&](int x, int y, std::int32_t, int) { ++first_[column(x, y) + 1]; });
  for (std::size_t c = 0; c < columns; ++c) first_[c + 1] += first_[c];
  changes_.resize(first_.back());
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  eachHit([&](int x, int y, std::int32_t z, int up) { changes_[next[column(x, y)]++] = {z, up}; });

  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, columns, 256), [&](const auto& range) {
    for (std::size_t c = range.begin(); c < range.end(); ++c) {
      const auto begin = changes_.begin() + static_cast<std::ptrdiff_t>(first_[c]);
      const auto end = changes_.begin() + static_cast<std::ptrdiff_t>(first_[c + 1]);
      std::sort(begin, end, [](const Change& a, const Change& b) {
        return a.z != b.z ? a.z < b.z : a.winding < b.winding;
      });
      int winding = 0;
      for (auto change = begin; change != end; ++change) {
        winding = rule == Rule::parity ? 1 - winding : winding + change->winding;
        change->winding = winding;
      }
    }
  });
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t i = first_[c]; i + 1 < first_[c + 1]; ++i) {
      const int length = changes_[i + 1].z - changes_[i].z;
      if (length == 0) continue;  // both changes lie between the same two voxel centers
      lowest_ = std::min(lowest_, changes_[i].winding);
      highest_ = std::max(highest_, changes_[i].winding);
      if (changes_[i].winding > 0) insideVoxels_ += static_cast<std::uint64_t>(length);
    }
  }
}

std::optional<std::size_t> Winding::columnAt(int x, int y) const {
  if (x < box_.min.x() || x > box_.max.x() || y < box_.min.y() || y > box_.max.y())
    return std::nullopt;
  return static_cast<std::size_t>(x - box_.min.x()) * static_cast<std::size_t>(box_.dims().y()) +
         static_cast<std::size_t>(y - box_.min.y());
}

int Winding::windingAbove(int x, int y) const {
  const std::optional<std::size_t> c = columnAt(x, y);
  return !c || first_[*c] == first_[*c + 1] ? 0 : changes_[first_[*c + 1] - 1].winding;
}

int Winding::at(const openvdb::Coord& voxel) const {
  const std::optional<std::size_t> c = columnAt(voxel.x(), voxel.y());
  if (!c) return 0;
  const auto begin = changes_.begin() + static_cast<std::ptrdiff_t>(first_[*c]);
  const auto end = changes_.begin() + static_cast<std::ptrdiff_t>(first_[*c + 1]);
  const auto above = std::upper_bound(
      begin, end, voxel.z(), [](int level, const Change& change) { return level < change.z; });
  return above == begin ? 0 : std::prev(above)->winding;
}

}  // namespace sherd
