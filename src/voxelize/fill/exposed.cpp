// The parts of a mesh that bound its solid.
#include "voxelize/fill/exposed.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "base/cancel_flag.h"
#include "mesh/search/boxes.h"
#include "mesh/triangle_area.h"

namespace sherd {
namespace {

using Corners = std::array<glm::dvec3, 3>;

// Offset in voxels at which the two sides of a surface are sampled.
constexpr double kStepBack = 1e-3;

// Lengths of longest edges, in voxels.  A triangle that others cross is subdivided above kLargest,
// sampled at four points down to kSmall, and at its center below.  The parts of a subdivided
// triangle are sampled at four points down to kSmallest.
constexpr double kLargest = 1.0;
constexpr double kSmall = 0.5;
constexpr double kSmallest = 0.25;

enum class Verdict { no, yes, mixed };

// Whether another triangle comes so near to the interior of a triangle that it may separate exposed
// from hidden parts of it.
bool crosses(const Corners& other, const Corners& t, const glm::dvec3& normal) {
  constexpr double kNear = 2.0 * kStepBack, kMargin = 0.01;  // voxels
  // The part of the other triangle within kNear of this triangle's plane.
  std::array<glm::dvec3, 8> section;
  std::size_t count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 &a = other[k], &b = other[(k + 1) % 3];
    const double u = glm::dot(a - t[0], normal), v = glm::dot(b - t[0], normal);
    if (std::abs(u) <= kNear) section[count++] = a;
    for (const double level : {u < v ? -kNear : kNear, u < v ? kNear : -kNear}) {
      if ((u < level) != (v < level)) section[count++] = a + (level - u) / (v - u) * (b - a);
    }
  }
  if (count == 0) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 &a = t[k], &b = t[(k + 1) % 3];
    const glm::dvec3 inwards = glm::normalize(glm::cross(normal, b - a));
    double deepest = -1.0;
    for (std::size_t i = 0; i < count; ++i) {
      deepest = std::max(deepest, glm::dot(section[i] - a, inwards));
    }
    if (deepest < kMargin) return false;
  }
  for (std::size_t k = 0; k < count; ++k) {  // is the triangle beyond an edge of the section?
    const glm::dvec3 &a = section[k], &b = section[(k + 1) % count];
    const glm::dvec3 side = glm::cross(normal, b - a);
    const double length = glm::length(side);
    if (length < kMargin) continue;
    double least = 1.0, most = -1.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double at = glm::dot(section[i] - a, side) / length;
      least = std::min(least, at), most = std::max(most, at);
    }
    double low = 1e300, high = -1e300;
    for (const glm::dvec3& corner : t) {
      const double at = glm::dot(corner - a, side) / length;
      low = std::min(low, at), high = std::max(high, at);
    }
    if (low > most - kMargin || high < least + kMargin) return false;
  }
  return true;
}

// Determines the exposed parts of one triangle of the mesh.
class ExposedParts {
 public:
  ExposedParts(const GeneralizedWinding& winding, const Corners& triangle)
      : winding_(winding), triangle_(triangle) {
    const glm::dvec3 cross = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
    area_ = glm::length(cross);
    normal_ = cross / area_;
  }
  ExposedParts(const ExposedParts&) = delete;
  ExposedParts& operator=(const ExposedParts&) = delete;
  ~ExposedParts() { winding_.work().add(steps_); }

  // Returns whether all or none of the triangle is kept, or `mixed` after adding the kept parts to
  // `kept`.
  //   throws  TooMuchWork
  Verdict keep(std::vector<Corners>& kept) const {
    if (area_ == 0.0) return Verdict::no;
    count(0);
    const std::array<glm::dvec3, 4> samples = samplesOf(triangle_);
    if (winding_.isPlain(boxOf(triangle_), samples, longestEdge(triangle_))) return Verdict::yes;
    // For a single sample the tree finds the crossings faster than a list of nearby triangles.
    // Small triangles have a single sample, even if others cross them.
    const bool isSmall = longestEdge(triangle_) <= kSmall;
    const Verdict verdict =
        classify(triangle_, isSmall ? std::vector<std::uint32_t>() : near(kTouching), kSmall);
    if (verdict != Verdict::mixed) return verdict;
    return keep(triangle_, near(kAround), kSmall, kept);
  }

 private:
  static constexpr double kAround = 1.0;     // voxels; more than the distance to a voxel center
  static constexpr double kTouching = 0.01;  // voxels; triangles that cross are nearer

  // Returns the triangles whose boxes are within `distance` along each axis.
  std::vector<std::uint32_t> near(double distance) const {
    return winding_.tree().meeting(widened(boxOf(triangle_), distance));
  }

  Verdict keep(const Corners& t, const std::vector<std::uint32_t>& around, double smallest,
               std::vector<Corners>& kept) const {
    count(around.size());
    const Verdict verdict = classify(t, around, smallest, around);
    if (verdict != Verdict::mixed) return verdict;
    // Halve the longest edge, so that a needle becomes short parts and not thinner needles.
    std::size_t from = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (glm::distance(t[k], t[(k + 1) % 3]) > glm::distance(t[from], t[(from + 1) % 3])) from = k;
    }
    const glm::dvec3 a = t[from], b = t[(from + 1) % 3], c = t[(from + 2) % 3];
    const glm::dvec3 half = 0.5 * (a + b);
    for (const Corners& part : {Corners{a, half, c}, Corners{half, b, c}}) {
      if (keep(part, aroundPart(part, around), kSmallest, kept) == Verdict::yes) {
        kept.push_back(part);
      }
    }
    return Verdict::mixed;
  }

  //   crossing  triangles that may cross `t`
  //   around    the triangles that decide the sides; if omitted, all of the mesh
  template <class... Around>
  Verdict classify(const Corners& t, const std::vector<std::uint32_t>& crossing, double smallest,
                   const Around&... around) const {
    const double size = longestEdge(t);
    const std::array<glm::dvec3, 4> samples = samplesOf(t);
    if (size > smallest && mayBeMixed(t, crossing, samples)) {
      if (size > kLargest) return Verdict::mixed;
      const bool first = isExposed(samples[0], around...);
      for (std::size_t k = 1; k < 4; ++k) {
        if (isExposed(samples[k], around...) != first) return Verdict::mixed;
      }
    }
    return isExposed(samples[0], around...) ? Verdict::yes : Verdict::no;
  }

  // Whether one sample may not be enough.
  bool mayBeMixed(const Corners& t, const std::vector<std::uint32_t>& crossing,
                  const std::array<glm::dvec3, 4>& samples) const {
    return std::any_of(crossing.begin(), crossing.end(),
                       [&](std::uint32_t other) {
                         const Corners corners = winding_.tree().corners(other);
                         return corners != triangle_ && crosses(corners, t, normal_);
                       }) ||
           !winding_.isFarFromHoles(samples, longestEdge(t));
  }

  template <class... Around>
  bool isExposed(const glm::dvec3& point, const Around&... around) const {
    const glm::dvec3 behind = point - kStepBack * normal_, before = point + kStepBack * normal_;
    const double first = winding_.near(behind, around...);
    const int entries = winding_.tree().entries(behind, before, around...);
    if (separates(first, first + entries)) return true;
    if (winding_.isSteady(point, first) && winding_.isSteady(point, first + entries)) return false;
    // Also exposed if the winding number passes 0.5 between the voxels on both sides, even without
    // a triangle.  The surface that closes a hole ends a voxel away from triangles, so these
    // triangles replace it.
    constexpr double kAside = 0.5;
    const double back = winding_.near(behind, point - kAside * normal_);
    const double front = winding_.near(behind, point + kAside * normal_) + entries;
    return separates(back, front) || separates(back, back + entries) ||
           separates(front - entries, front);
  }

  // Whether only one of two winding numbers is inside.
  static bool separates(double a, double b) { return (a >= 0.5) != (b >= 0.5); }

  std::vector<std::uint32_t> aroundPart(const Corners& part,
                                        const std::vector<std::uint32_t>& around) const {
    std::vector<std::uint32_t> some;
    const Box box = widened(boxOf(part), kAround);
    for (const std::uint32_t other : around) {
      if (meet(boxOf(winding_.tree().corners(other)), box)) some.push_back(other);
    }
    return some;
  }

  // Returns the center, and a point near each corner.
  static std::array<glm::dvec3, 4> samplesOf(const Corners& t) {
    const glm::dvec3 center = (t[0] + t[1] + t[2]) / 3.0;
    const auto near = [&](const glm::dvec3& corner) { return center + 0.9 * (corner - center); };
    return {center, near(t[0]), near(t[1]), near(t[2])};
  }

  // Counts the work of a part with triangles around it, in batches.
  void count(std::size_t triangles) const {
    constexpr std::uint64_t kStepsPerPart = 60, kBatch = 1024;
    steps_ += 2 * triangles + kStepsPerPart;
    if (steps_ < kBatch) return;
    winding_.work().add(std::exchange(steps_, 0));
    winding_.work().check();
  }

  const GeneralizedWinding& winding_;
  Corners triangle_;
  mutable std::uint64_t steps_ = 0;  // not yet added
  double area_ = 0.0;                // twice
  glm::dvec3 normal_{0.0};
};

}  // namespace

TriangleMesh exposedSurface(const TriangleMesh& mesh, const GeneralizedWinding& winding,
                            const Progress* progress) {
  constexpr std::size_t kChunkSize = 256;
  const std::size_t chunks = (mesh.triangles.size() + kChunkSize - 1) / kChunkSize;
  struct Kept {
    std::vector<glm::uvec3> whole;
    std::vector<Corners> parts;
  };
  std::vector<Kept> kept(chunks);  // joined in the triangles' order
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    if (stop.isSet()) return;
    const std::size_t end = std::min(mesh.triangles.size(), (chunk + 1) * kChunkSize);
    for (std::size_t i = chunk * kChunkSize; i < end; ++i) {
      const glm::uvec3& t = mesh.triangles[i];
      const Corners corners{mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]};
      if (ExposedParts(winding, corners).keep(kept[chunk].parts) == Verdict::yes) {
        kept[chunk].whole.push_back(t);
      }
    }
  });
  stop.throwIfSet();
  winding.work().check();
  TriangleMesh out{mesh.vertices, {}};
  for (const Kept& chunk : kept) {
    out.triangles.insert(out.triangles.end(), chunk.whole.begin(), chunk.whole.end());
    for (const Corners& part : chunk.parts) {
      const auto first = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.insert(out.vertices.end(), part.begin(), part.end());
      out.triangles.emplace_back(first, first + 1, first + 2);
    }
  }
  return out;
}

}  // namespace sherd
