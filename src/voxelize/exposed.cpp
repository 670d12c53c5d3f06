// Which of a mesh's surfaces bound its solid.
#include "voxelize/exposed.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "base/cancel_flag.h"
#include "mesh/boxes.h"

namespace sherd {
namespace {

using Corners = std::array<glm::dvec3, 3>;

// How far beside a surface its two sides are looked at, in voxels.
constexpr double kBeside = 1e-3;

// A triangle that others cross is looked at in four places when it is this small, in its middle
// only when it is smaller still, and cut no farther than to the smallest pieces.
constexpr double kLargestPiece = 1.0;
constexpr double kSmall = 0.5;
constexpr double kSmallestPiece = 0.25;

enum class Verdict { no, yes, mixed };

double longestEdge(const Corners& t) {
  return std::max(
      {glm::distance(t[0], t[1]), glm::distance(t[1], t[2]), glm::distance(t[2], t[0])});
}

// Whether another triangle comes so near to a triangle, but for its rim, that it may part it into
// what is exposed and what is not.
bool crosses(const Corners& other, const Corners& t, const glm::dvec3& normal) {
  constexpr double kNear = 2.0 * kBeside, kRim = 0.01;  // voxels
  // The part of the other that lies in the triangle's plane, give or take a little.
  std::array<glm::dvec3, 8> part;
  std::size_t count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 &a = other[k], &b = other[(k + 1) % 3];
    const double u = glm::dot(a - t[0], normal), v = glm::dot(b - t[0], normal);
    if (std::abs(u) <= kNear) part[count++] = a;
    for (const double level : {u < v ? -kNear : kNear, u < v ? kNear : -kNear}) {
      if ((u < level) != (v < level)) part[count++] = a + (level - u) / (v - u) * (b - a);
    }
  }
  if (count == 0) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 &a = t[k], &b = t[(k + 1) % 3];
    const glm::dvec3 inwards = glm::normalize(glm::cross(normal, b - a));
    double deepest = -1.0;
    for (std::size_t i = 0; i < count; ++i) {
      deepest = std::max(deepest, glm::dot(part[i] - a, inwards));
    }
    if (deepest < kRim) return false;
  }
  for (std::size_t k = 0; k < count; ++k) {  // beyond an edge of the part
    const glm::dvec3 &a = part[k], &b = part[(k + 1) % count];
    const glm::dvec3 side = glm::cross(normal, b - a);
    const double length = glm::length(side);
    if (length < kRim) continue;
    double least = 1.0, most = -1.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double at = glm::dot(part[i] - a, side) / length;
      least = std::min(least, at), most = std::max(most, at);
    }
    double low = 1e300, high = -1e300;
    for (const glm::dvec3& corner : t) {
      const double at = glm::dot(corner - a, side) / length;
      low = std::min(low, at), high = std::max(high, at);
    }
    if (low > most - kRim || high < least + kRim) return false;
  }
  return true;
}

// Looks at one triangle of the mesh, and at pieces of it.
class Look {
 public:
  Look(const GeneralisedWinding& winding, const Corners& triangle)
      : winding_(winding), triangle_(triangle) {
    const glm::dvec3 cross = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
    area_ = glm::length(cross);
    normal_ = cross / area_;
  }

  // What is kept of the triangle: all of it, nothing, or the pieces that are added to `kept`.
  Verdict keep(std::vector<Corners>& kept) const {
    if (area_ == 0.0) return Verdict::no;
    const std::array<glm::dvec3, 4> looks = looksOf(triangle_);
    if (winding_.isPlain(boxOf(triangle_), looks, longestEdge(triangle_))) return Verdict::yes;
    // For one look the tree tells what lies on the way sooner than a list of all that is around.
    // Small ones have one, whatever crosses them.
    const bool isSmall = longestEdge(triangle_) <= kSmall;
    const Verdict verdict =
        look(triangle_, isSmall ? std::vector<std::uint32_t>() : near(kTouching), kSmall);
    if (verdict != Verdict::mixed) return verdict;
    return keep(triangle_, near(kAround), kSmall, kept);
  }

 private:
  static constexpr double kAround = 1.0;     // voxels; the nearest centre is nearer
  static constexpr double kTouching = 0.01;  // what crosses a triangle is nearer

  // Triangles that are no farther away along each axis.
  std::vector<std::uint32_t> near(double distance) const {
    return winding_.tree().meeting(widened(boxOf(triangle_), distance));
  }

  Verdict keep(const Corners& t, const std::vector<std::uint32_t>& around, double smallest,
               std::vector<Corners>& kept) const {
    const Verdict verdict = look(t, around, smallest, around);
    if (verdict != Verdict::mixed) return verdict;
    // Halve the longest edge: a needle becomes short pieces, not thinner needles.
    std::size_t from = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (glm::distance(t[k], t[(k + 1) % 3]) > glm::distance(t[from], t[(from + 1) % 3])) from = k;
    }
    const glm::dvec3 a = t[from], b = t[(from + 1) % 3], c = t[(from + 2) % 3];
    const glm::dvec3 half = 0.5 * (a + b);
    for (const Corners& piece : {Corners{a, half, c}, Corners{half, b, c}}) {
      if (keep(piece, aroundPiece(piece, around), kSmallestPiece, kept) == Verdict::yes) {
        kept.push_back(piece);
      }
    }
    return Verdict::mixed;
  }

  // `crossing` are those that may part the triangle; sides are told by those around, or by all.
  template <class... Around>
  Verdict look(const Corners& t, const std::vector<std::uint32_t>& crossing, double smallest,
               const Around&... around) const {
    const double size = longestEdge(t);
    const std::array<glm::dvec3, 4> looks = looksOf(t);
    if (size > smallest && isMixed(t, crossing, looks)) {
      if (size > kLargestPiece) return Verdict::mixed;
      const bool first = isExposed(looks[0], around...);
      for (std::size_t k = 1; k < 4; ++k) {
        if (isExposed(looks[k], around...) != first) return Verdict::mixed;
      }
    }
    return isExposed(looks[0], around...) ? Verdict::yes : Verdict::no;
  }

  // Whether one look may not be enough.
  bool isMixed(const Corners& t, const std::vector<std::uint32_t>& crossing,
               const std::array<glm::dvec3, 4>& looks) const {
    return std::any_of(crossing.begin(), crossing.end(),
                       [&](std::uint32_t other) {
                         const Corners corners = winding_.tree().corners(other);
                         return corners != triangle_ && crosses(corners, t, normal_);
                       }) ||
           !winding_.isFarFromHoles(looks, longestEdge(t));
  }

  template <class... Around>
  bool isExposed(const glm::dvec3& point, const Around&... around) const {
    const glm::dvec3 behind = point - kBeside * normal_, before = point + kBeside * normal_;
    const double first = winding_.near(behind, around...);
    const int entries = winding_.tree().entries(behind, before, around...);
    if (part(first, first + entries)) return true;
    if (winding_.isSteady(point, first) && winding_.isSteady(point, first + entries)) return false;
    // Between the voxels on both sides the winding number passes a half, be it by itself.  The
    // surface that closes a hole does not come so near to triangles, so these stand for it.
    constexpr double kAside = 0.5;
    const double back = winding_.near(behind, point - kAside * normal_);
    const double front = winding_.near(behind, point + kAside * normal_) + entries;
    return part(back, front) || part(back, back + entries) || part(front - entries, front);
  }

  static bool part(double a, double b) { return (a >= 0.5) != (b >= 0.5); }

  std::vector<std::uint32_t> aroundPiece(const Corners& piece,
                                         const std::vector<std::uint32_t>& around) const {
    std::vector<std::uint32_t> some;
    const Box box = widened(boxOf(piece), kAround);
    for (const std::uint32_t other : around) {
      if (meet(boxOf(winding_.tree().corners(other)), box)) some.push_back(other);
    }
    return some;
  }

  // The middle, and near the corners.
  static std::array<glm::dvec3, 4> looksOf(const Corners& t) {
    const glm::dvec3 middle = (t[0] + t[1] + t[2]) / 3.0;
    const auto near = [&](const glm::dvec3& corner) { return middle + 0.9 * (corner - middle); };
    return {middle, near(t[0]), near(t[1]), near(t[2])};
  }

  const GeneralisedWinding& winding_;
  Corners triangle_;
  double area_ = 0.0;  // twice
  glm::dvec3 normal_{0.0};
};

}  // namespace

TriangleMesh exposedSurface(const TriangleMesh& mesh, const GeneralisedWinding& winding,
                            const Progress* progress) {
  constexpr std::size_t kGrain = 256;
  const std::size_t chunks = (mesh.triangles.size() + kGrain - 1) / kGrain;
  struct Kept {
    std::vector<glm::uvec3> whole;
    std::vector<Corners> pieces;
  };
  std::vector<Kept> kept(chunks);  // joined in the triangles' order
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    if (stop.isSet()) return;
    const std::size_t end = std::min(mesh.triangles.size(), (chunk + 1) * kGrain);
    for (std::size_t i = chunk * kGrain; i < end; ++i) {
      const glm::uvec3& t = mesh.triangles[i];
      const Corners corners{mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]};
      if (Look(winding, corners).keep(kept[chunk].pieces) == Verdict::yes) {
        kept[chunk].whole.push_back(t);
      }
    }
  });
  stop.throwIfSet();
  TriangleMesh out{mesh.vertices, {}};
  for (const Kept& chunk : kept) {
    out.triangles.insert(out.triangles.end(), chunk.whole.begin(), chunk.whole.end());
    for (const Corners& piece : chunk.pieces) {
      const auto first = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.insert(out.vertices.end(), piece.begin(), piece.end());
      out.triangles.emplace_back(first, first + 1, first + 2);
    }
  }
  return out;
}

}  // namespace sherd
