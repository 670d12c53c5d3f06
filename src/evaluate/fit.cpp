// Measures how well fragments fit each other and the intact mesh.
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <sherd/points.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <set>
#include <string>

#include "base/cancel_flag.h"
#include "base/random.h"
#include "evaluate/assembly.h"
#include "evaluate/summary.h"

namespace sherd {
namespace {

constexpr std::size_t kTriesPerPoint = 32;   // a shell fills little of its box
constexpr std::size_t kCancelInterval = 64;  // points between checks for cancellation

/// The kind of surface that a sample of a fragment lies on.
enum class Kind { original, fracture, neither };

struct Sample {
  Kind kind = Kind::neither;
  double error = 0.0;           ///< distance to the intact mesh, if there is one
  Assembly::Location location;  ///< relative to the other fragments
};

/// Inputs that all measurements share.
struct Inputs {
  const Assembly& assembly;
  const MeshDistance* whole;  ///< or null
  const FitOptions& options;
  double tolerance;   ///< world units
  double rounding;    ///< world units
  std::set<int> ids;  ///< of all fragments
  const Progress* progress;
};

/// Returns whether the nearest other fragment lies within 60 degrees of the normal, so that the
/// point is on a fracture surface and not beside one.
bool facesNeighbor(const glm::dvec3& point, const glm::dvec3& normal,
                   const Assembly::Location& location, double rounding) {
  if (location.distance <= rounding) return true;
  constexpr double kCosine = 0.5;  // of 60 degrees
  return glm::dot(normal, location.closestPoint - point) >= kCosine * location.distance;
}

Kind kindByNeighbor(const Inputs& in, std::uint16_t neighbor) {
  if (neighbor == 0) return Kind::original;
  return in.ids.contains(neighbor) ? Kind::fracture : Kind::neither;
}

Kind kindByLocation(const Inputs& in, const Sample& sample, bool faces) {
  const Assembly::Location& location = sample.location;
  if (location.depth > 0.0) return Kind::fracture;
  const bool touched = faces && location.distance <= in.tolerance;
  if (!in.whole) return touched ? Kind::fracture : Kind::original;
  if (touched && location.distance < sample.error) return Kind::fracture;
  return sample.error <= in.tolerance ? Kind::original : Kind::neither;
}

Sample sampleAt(const Inputs& in, std::size_t fragment, const SurfacePoints& points,
                std::size_t k) {
  const glm::dvec3& point = points.positions[k];
  Sample sample;
  sample.location = in.assembly.locate(point, fragment, in.rounding);
  if (in.whole) sample.error = in.whole->distance(point);
  const bool known = !in.assembly.fragment(fragment).mesh.neighbor.empty();
  sample.kind =
      known ? kindByNeighbor(in, points.neighbor[k])
            : kindByLocation(in, sample,
                             facesNeighbor(point, points.normals[k], sample.location, in.rounding));
  return sample;
}

/// Measurements of one fragment.
struct Measurement {
  FragmentFit fit;
  std::vector<double> errors;
  std::vector<double> gaps;
};

std::vector<WeightedDistance> weighted(const std::vector<double>& distances, double weight) {
  std::vector<WeightedDistance> result;
  result.reserve(distances.size());
  for (const double d : distances) result.push_back({d, weight});
  return result;
}

Measurement summarize(const Inputs& in, const std::vector<Sample>& samples) {
  Measurement result;
  std::size_t original = 0, fracture = 0, inside = 0;
  std::vector<char> near(in.assembly.count(), 0);
  for (const Sample& s : samples) {
    original += s.kind == Kind::original;
    fracture += s.kind == Kind::fracture;
    inside += s.location.depth > 0.0;
    result.fit.overlapDepth = std::max(result.fit.overlapDepth, s.location.depth);
    if (s.kind == Kind::original && in.whole) result.errors.push_back(s.error);
    if (s.kind != Kind::fracture || s.location.nearest == Assembly::kNone) continue;
    result.gaps.push_back(s.location.depth > 0.0 ? 0.0 : s.location.distance);
    if (s.location.distance <= in.tolerance || s.location.depth > 0.0) near[s.location.nearest] = 1;
  }
  const auto count = static_cast<double>(samples.size());
  result.fit.originalShare = static_cast<double>(original) / count;
  result.fit.fractureShare = static_cast<double>(fracture) / count;
  result.fit.insideShare = static_cast<double>(inside) / count;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (near[i]) result.fit.neighbors.push_back(in.assembly.fragment(i).id);
  }
  std::sort(result.fit.neighbors.begin(), result.fit.neighbors.end());
  result.fit.surfaceError = summaryOf(weighted(result.errors, 1.0));
  result.fit.gap = summaryOf(weighted(result.gaps, 1.0));
  return result;
}

glm::dvec3 pointIn(const Box& box, std::uint64_t seed, std::uint64_t item) {
  glm::dvec3 p;
  for (int axis = 0; axis < 3; ++axis) {
    const double share = randomUnit(seed, Stage::fitSpace, 3 * item + static_cast<unsigned>(axis));
    p[axis] = box.min[axis] + share * (box.max[axis] - box.min[axis]);
  }
  return p;
}

/// Numbers of a box's random points that are inside a solid, and that are also marked.
struct Tally {
  std::size_t inside = 0;
  std::size_t marked = 0;

  std::optional<double> share() const {
    if (inside == 0) return {};
    return static_cast<double>(marked) / static_cast<double>(inside);
  }
};

/// Samples a box until `count` points are inside, at most kTriesPerPoint * count points.
template <class Inside, class Marked>
Tally tally(const Box& box, std::size_t count, std::uint64_t seed, const Progress* progress,
            Inside inside, Marked marked) {
  Tally result;
  std::vector<char> found(count);  // of one batch: 0 outside, 1 inside, 2 inside and marked
  for (std::size_t batch = 0; batch < kTriesPerPoint && result.inside < count; ++batch) {
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      if (i % kCancelInterval == 0) throwIfCancelled(progress);
      const glm::dvec3 point = pointIn(box, seed, batch * count + i);
      found[i] = !inside(point) ? 0 : marked(point) ? 2 : 1;
    });
    for (std::size_t i = 0; i < count && result.inside < count; ++i) {
      result.inside += found[i] > 0;
      result.marked += found[i] > 1;
    }
  }
  return result;
}

Measurement measureFragment(const Inputs& in, std::size_t i) {
  const FragmentMesh& fragment = in.assembly.fragment(i);
  const std::uint64_t seed = randomBits(in.options.seed, Stage::fitFragment, i + 1);
  const SurfacePoints points =
      samplePoints(fragment.mesh, {.count = in.options.samples, .seed = seed});
  std::vector<Sample> samples(in.options.samples);
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t k) {
    if (k % kCancelInterval == 0) throwIfCancelled(in.progress);
    samples[k] = sampleAt(in, i, points, k);
  });
  Measurement result = summarize(in, samples);
  if (in.assembly.closed(i)) {
    result.fit.overlapShare =
        tally(
            bounds(fragment.mesh), in.options.samples, seed, in.progress,
            [&](const glm::dvec3& p) { return in.assembly.mesh(i).likelyContains(p); },
            [&](const glm::dvec3& p) { return in.assembly.anyContains(p, i, in.rounding); })
            .share();
  }
  return result;
}

void addWhole(Fit& result, const Inputs& in, const TriangleMesh& whole) {
  const std::uint64_t seed = randomBits(in.options.seed, Stage::fitFragment, 0);
  const SurfacePoints points = samplePoints(whole, {.count = in.options.samples, .seed = seed});
  std::vector<double> distances(in.options.samples);
  tbb::parallel_for(std::size_t{0}, distances.size(), [&](std::size_t k) {
    if (k % kCancelInterval == 0) throwIfCancelled(in.progress);
    distances[k] = in.assembly.locate(points.positions[k], Assembly::kNone, in.rounding).distance;
  });
  result.missing = summaryOf(weighted(distances, 1.0));
  if (openEdges(whole) > 0) return;
  result.wholeVolume = volume(whole);
  for (std::size_t i = 0; i < in.assembly.count(); ++i) {
    if (!in.assembly.closed(i)) return;  // an open mesh has no inside
  }
  result.voidShare =
      tally(
          in.whole->box(), in.options.samples, seed, in.progress,
          [&](const glm::dvec3& p) { return in.whole->likelyContains(p); },
          [&](const glm::dvec3& p) { return !in.assembly.anyContains(p, Assembly::kNone, 0.0); })
          .share();
}

void sumUpFit(Fit& result, std::span<const FragmentMesh> fragments,
              const std::vector<Measurement>& measurements) {
  std::vector<WeightedDistance> errors, gaps;
  double overlap = 0.0, volumes = 0.0;
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const double weight = area(fragments[i].mesh);
    for (const double d : measurements[i].errors) errors.push_back({d, weight});
    for (const double d : measurements[i].gaps) gaps.push_back({d, weight});
    const FragmentFit& one = measurements[i].fit;
    result.overlapDepth = std::max(result.overlapDepth, one.overlapDepth);
    if (one.overlapShare) {
      const double size = std::abs(volume(fragments[i].mesh));
      overlap += size * *one.overlapShare;
      volumes += size;
    }
    result.fragments.push_back(one);
  }
  if (volumes > 0.0) result.overlapShare = overlap / volumes;
  result.surfaceError = summaryOf(std::move(errors));
  result.gap = summaryOf(std::move(gaps));
}

void checkFit(std::span<const FragmentMesh> fragments, const FitOptions& options) {
  if (options.samples == 0 || options.samples > kMaxPoints) {
    throw Error(ErrorCode::usage, "fit: " + std::to_string(options.samples) +
                                      " samples, expected 1 to " + std::to_string(kMaxPoints));
  }
  if (!(options.tolerance > 0.0 && std::isfinite(options.tolerance))) {
    throw Error(ErrorCode::usage, "fit: the tolerance is " + std::to_string(options.tolerance) +
                                      ", expected above 0");
  }
  for (const FragmentMesh& f : fragments) {
    if (!(area(f.mesh) > 0.0)) {
      throw Error(ErrorCode::input,
                  "fit: fragment " + std::to_string(f.id) + " has no area; a surface is needed");
    }
  }
}

std::set<int> idsOf(std::span<const FragmentMesh> fragments) {
  std::set<int> ids;
  for (const FragmentMesh& f : fragments) ids.insert(f.id);
  return ids;
}

}  // namespace

Fit fit(std::span<const FragmentMesh> fragments, const TriangleMesh* whole,
        const FitOptions& options, const Progress* progress) {
  checkFit(fragments, options);
  Fit result;
  if (fragments.empty()) return result;
  const Assembly assembly(fragments);
  std::optional<MeshDistance> wholeDistance;
  if (whole) wholeDistance.emplace(*whole);
  const Box box = whole ? wholeDistance->box() : assembly.box();
  result.diagonal = glm::length(box.max - box.min);
  const Inputs inputs{assembly,
                      wholeDistance ? &*wholeDistance : nullptr,
                      options,
                      options.tolerance * result.diagonal,
                      Assembly::kRounding * result.diagonal,
                      idsOf(fragments),
                      progress};

  std::vector<Measurement> measurements(fragments.size());
  tbb::parallel_for(std::size_t{0}, fragments.size(),
                    [&](std::size_t i) { measurements[i] = measureFragment(inputs, i); });
  sumUpFit(result, fragments, measurements);
  if (whole) addWhole(result, inputs, *whole);
  return result;
}

}  // namespace sherd
