// Measures how well fragments fit.
#include <sherd/error.h>
#include <sherd/fit.h>
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

constexpr double kRounding = 2e-6;          // of the diagonal: how near a surface a point is on it
constexpr std::size_t kTriesPerPoint = 32;  // a shell fills little of its box
constexpr std::size_t kBetweenLooks = 64;   // points: whether to stop

/// What a point of a fragment's surface is part of.
enum class Part { original, fracture, neither };

struct Sample {
  Part part = Part::neither;
  double error = 0.0;  ///< to the unbroken mesh, if there is one
  Assembly::Place place;
};

/// What is asked, and whom.
struct Question {
  const Assembly& assembly;
  const MeshDistance* whole;  ///< or null
  const FitOptions& options;
  double tolerance;   ///< world units
  double rounding;    ///< world units
  std::set<int> ids;  ///< of the fragments that are there
  const Progress* progress;
};

/// Whether the way to the nearest other fragment goes out of the surface, not along it: to it, the
/// point's own surface is a fracture.
bool facesIt(const glm::dvec3& point, const glm::dvec3& normal, const Assembly::Place& place,
             double rounding) {
  if (place.distance <= rounding) return true;
  constexpr double kCosine = 0.5;  // of 60 degrees
  return glm::dot(normal, place.point - point) >= kCosine * place.distance;
}

Part partByFacing(const Question& q, std::uint16_t facing) {
  if (facing == 0) return Part::original;
  return q.ids.contains(facing) ? Part::fracture : Part::neither;
}

Part partByPlace(const Question& q, const Sample& sample, bool facing) {
  const Assembly::Place& place = sample.place;
  if (place.depth > 0.0) return Part::fracture;
  const bool touched = facing && place.distance <= q.tolerance;
  if (!q.whole) return touched ? Part::fracture : Part::original;
  if (touched && place.distance < sample.error) return Part::fracture;
  return sample.error <= q.tolerance ? Part::original : Part::neither;
}

Sample lookAt(const Question& q, std::size_t fragment, const SurfacePoints& points, std::size_t k) {
  const glm::dvec3& point = points.positions[k];
  Sample sample;
  sample.place = q.assembly.placeOf(point, fragment, q.rounding);
  if (q.whole) sample.error = q.whole->distance(point);
  sample.part =
      q.assembly.fragment(fragment).facing.empty()
          ? partByPlace(q, sample, facesIt(point, points.normals[k], sample.place, q.rounding))
          : partByFacing(q, points.facing[k]);
  return sample;
}

/// What the points of one fragment tell.
struct Told {
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

Told tell(const Question& q, const std::vector<Sample>& samples) {
  Told told;
  std::size_t original = 0, fracture = 0, inside = 0;
  std::vector<char> near(q.assembly.count(), 0);
  for (const Sample& s : samples) {
    original += s.part == Part::original;
    fracture += s.part == Part::fracture;
    inside += s.place.depth > 0.0;
    told.fit.overlapDepth = std::max(told.fit.overlapDepth, s.place.depth);
    if (s.part == Part::original && q.whole) told.errors.push_back(s.error);
    if (s.part != Part::fracture || s.place.nearest == Assembly::kNone) continue;
    told.gaps.push_back(s.place.depth > 0.0 ? 0.0 : s.place.distance);
    if (s.place.distance <= q.tolerance || s.place.depth > 0.0) near[s.place.nearest] = 1;
  }
  const auto count = static_cast<double>(samples.size());
  told.fit.originalShare = static_cast<double>(original) / count;
  told.fit.fractureShare = static_cast<double>(fracture) / count;
  told.fit.insideShare = static_cast<double>(inside) / count;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (near[i]) told.fit.neighbours.push_back(q.assembly.fragment(i).id);
  }
  std::sort(told.fit.neighbours.begin(), told.fit.neighbours.end());
  told.fit.surfaceError = summaryOf(weighted(told.errors, 1.0));
  told.fit.gap = summaryOf(weighted(told.gaps, 1.0));
  return told;
}

glm::dvec3 pointIn(const Box& box, std::uint64_t seed, std::uint64_t item) {
  glm::dvec3 p;
  for (int axis = 0; axis < 3; ++axis) {
    const double share = randomUnit(seed, Stage::fitSpace, 3 * item + static_cast<unsigned>(axis));
    p[axis] = box.min[axis] + share * (box.max[axis] - box.min[axis]);
  }
  return p;
}

/// Of points of a box: how many are inside something, and how many of these are marked.
struct Tally {
  std::size_t inside = 0;
  std::size_t marked = 0;

  std::optional<double> share() const {
    if (inside == 0) return {};
    return static_cast<double>(marked) / static_cast<double>(inside);
  }
};

/// Draw points of a box until `count` of them are inside, or too many are not.
template <class Inside, class Marked>
Tally tally(const Box& box, std::size_t count, std::uint64_t seed, const Progress* progress,
            Inside inside, Marked marked) {
  Tally result;
  std::vector<char> found(count);  // a round: 0 outside, 1 inside, 2 marked, too
  for (std::size_t round = 0; round < kTriesPerPoint && result.inside < count; ++round) {
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      if (i % kBetweenLooks == 0) throwIfCancelled(progress);
      const glm::dvec3 point = pointIn(box, seed, round * count + i);
      found[i] = !inside(point) ? 0 : marked(point) ? 2 : 1;
    });
    for (std::size_t i = 0; i < count && result.inside < count; ++i) {
      result.inside += found[i] > 0;
      result.marked += found[i] > 1;
    }
  }
  return result;
}

Told tellFragment(const Question& q, std::size_t i) {
  const FragmentMesh& fragment = q.assembly.fragment(i);
  const std::uint64_t seed = randomBits(q.options.seed, Stage::fitPiece, i + 1);
  const SurfacePoints points =
      samplePoints(fragment.mesh, fragment.facing, {.count = q.options.samples, .seed = seed});
  std::vector<Sample> samples(q.options.samples);
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t k) {
    if (k % kBetweenLooks == 0) throwIfCancelled(q.progress);
    samples[k] = lookAt(q, i, points, k);
  });
  Told told = tell(q, samples);
  if (q.assembly.closed(i)) {
    told.fit.overlapShare =
        tally(
            bounds(fragment.mesh), q.options.samples, seed, q.progress,
            [&](const glm::dvec3& p) { return q.assembly.mesh(i).likelyContains(p); },
            [&](const glm::dvec3& p) { return q.assembly.anyHolds(p, i, q.rounding); })
            .share();
  }
  return told;
}

void addWhole(Fit& result, const Question& q, const TriangleMesh& whole) {
  const std::uint64_t seed = randomBits(q.options.seed, Stage::fitPiece, 0);
  const SurfacePoints points = samplePoints(whole, {}, {.count = q.options.samples, .seed = seed});
  std::vector<double> distances(q.options.samples);
  tbb::parallel_for(std::size_t{0}, distances.size(), [&](std::size_t k) {
    if (k % kBetweenLooks == 0) throwIfCancelled(q.progress);
    distances[k] = q.assembly.placeOf(points.positions[k], Assembly::kNone, q.rounding).distance;
  });
  result.missing = summaryOf(weighted(distances, 1.0));
  if (openEdges(whole) > 0) return;
  result.wholeVolume = volume(whole);
  for (std::size_t i = 0; i < q.assembly.count(); ++i) {
    if (!q.assembly.closed(i)) return;  // what an open one fills is not known
  }
  result.voidShare =
      tally(
          q.whole->box(), q.options.samples, seed, q.progress,
          [&](const glm::dvec3& p) { return q.whole->likelyContains(p); },
          [&](const glm::dvec3& p) { return !q.assembly.anyHolds(p, Assembly::kNone, 0.0); })
          .share();
}

void sumUp(Fit& result, std::span<const FragmentMesh> fragments, const std::vector<Told>& told) {
  std::vector<WeightedDistance> errors, gaps;
  double overlap = 0.0, volumes = 0.0;
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const double weight = area(fragments[i].mesh);
    for (const double d : told[i].errors) errors.push_back({d, weight});
    for (const double d : told[i].gaps) gaps.push_back({d, weight});
    const FragmentFit& one = told[i].fit;
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

void check(std::span<const FragmentMesh> fragments, const FitOptions& options) {
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
  check(fragments, options);
  Fit result;
  if (fragments.empty()) return result;
  const Assembly assembly(fragments);
  std::optional<MeshDistance> wholeDistance;
  if (whole) wholeDistance.emplace(*whole);
  const Box box = whole ? wholeDistance->box() : assembly.box();
  result.diagonal = glm::length(box.max - box.min);
  const Question question{assembly,
                          wholeDistance ? &*wholeDistance : nullptr,
                          options,
                          options.tolerance * result.diagonal,
                          kRounding * result.diagonal,
                          idsOf(fragments),
                          progress};

  std::vector<Told> told(fragments.size());
  tbb::parallel_for(std::size_t{0}, fragments.size(),
                    [&](std::size_t i) { told[i] = tellFragment(question, i); });
  sumUp(result, fragments, told);
  if (whole) addWhole(result, question, *whole);
  return result;
}

}  // namespace sherd
