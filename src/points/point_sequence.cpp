// The points of a surface, any of which can be made without those before it.
//
// Uniform and Halton points are functions of their number.  Poisson points are chosen among
// uniform candidates, and points by the paper's rule are shuffled: what is chosen is kept as
// numbers, and the points are made again from these.
#include "points/point_sequence.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "base/random.h"
#include "points/eliminate.h"
#include "seed/draw/radical_inverse.h"

namespace sherd {
namespace {

using DrawOf = std::function<Draw(std::size_t i)>;

DrawOf uniformDraws(const SurfaceByArea& surface, std::uint64_t seed, Stage stage) {
  return [&surface, seed, stage](std::size_t i) -> Draw {
    return {surface.triangleAt(randomUnit(seed, stage, 3 * i)), randomUnit(seed, stage, 3 * i + 1),
            randomUnit(seed, stage, 3 * i + 2)};
  };
}

/// Scrambled Halton sequences of bases 2, 3 and 5: numbers in [0, 1) of about 40 bits.
class Halton {
 public:
  explicit Halton(std::uint64_t seed)
      : a(2, 40, seed, Stage::pointDigit),
        b(3, 25, seed, Stage::pointDigit),
        c(5, 17, seed, Stage::pointDigit) {}

  RadicalInverse a, b, c;
};

DrawOf haltonDraws(const SurfaceByArea& surface, std::uint64_t seed) {
  return [&surface, halton = std::make_shared<const Halton>(seed)](std::size_t i) -> Draw {
    return {surface.triangleAt(halton->a.at(i)), halton->b.at(i), halton->c.at(i)};
  };
}

DrawOf poissonDraws(const SurfaceByArea& surface, std::size_t count, std::uint64_t seed) {
  const DrawOf candidate = uniformDraws(surface, seed, Stage::pointCandidate);
  std::vector<glm::dvec3> candidates;
  candidates.reserve(count * kCandidatesPerPoint);
  for (std::size_t i = 0; i < count * kCandidatesPerPoint; ++i) {
    const Draw draw = candidate(i);
    candidates.push_back(surface.at(draw.triangle).pointIn(draw.u, draw.v));
  }
  // Rounded to 24 bits, so that areas that were summed in another order give the same points.
  int exponent = 0;
  const double mantissa = std::frexp(surface.area(), &exponent);
  const double area = std::ldexp(std::round(std::ldexp(mantissa, 24)), exponent - 24);
  const std::vector<std::size_t> chosen = eliminated(candidates, count, area);
  const auto kept =
      std::make_shared<const std::vector<std::uint32_t>>(chosen.begin(), chosen.end());
  return [candidate, kept](std::size_t i) { return candidate((*kept)[i]); };
}

/// The points of each triangle by the paper's rule, numbered by triangle.
class PerTriangle {
 public:
  PerTriangle(const SurfaceByArea& surface, std::size_t count) {
    std::size_t end = 0;
    for (std::size_t t = 0; t < surface.triangles(); ++t) {
      const double share = surface.area(t) / surface.area();
      if (share == 0.0) continue;
      const double own = std::ceil(share * static_cast<double>(count));
      triangles_.push_back(static_cast<std::uint32_t>(t));
      ends_.push_back(end += std::max<std::size_t>(1, static_cast<std::size_t>(own)));
    }
    // Rounding of the shares can lose at most the last point.
    if (end < count) ends_.back() = count;
  }

  /// At least `count`, as the parts are rounded up.
  [[nodiscard]] std::size_t points() const { return ends_.back(); }
  [[nodiscard]] std::size_t triangleOf(std::size_t point) const {
    return triangles_[static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end(), point) -
                                               ends_.begin())];
  }

 private:
  std::vector<std::uint32_t> triangles_;  // those with an area
  std::vector<std::size_t> ends_;         // [triangles_] points of these and those before
};

DrawOf perTriangleDraws(const SurfaceByArea& surface, const PointOptions& options) {
  struct Chosen {
    PerTriangle points;
    std::vector<std::uint32_t> order;
    Halton halton;
  };
  const auto chosen = std::make_shared<Chosen>(
      Chosen{PerTriangle(surface, options.count), {}, Halton(options.seed)});
  std::vector<std::uint32_t>& order = chosen->order;
  order.resize(chosen->points.points());
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  for (std::size_t i = 0; i < options.count; ++i) {  // a partial Fisher-Yates shuffle
    std::swap(order[i],
              order[i + randomBelow(order.size() - i, options.seed, Stage::pointShuffle, i)]);
  }
  order.resize(options.count);
  order.shrink_to_fit();
  const bool even = options.sampler == PointSampler::halton;
  return [chosen = std::shared_ptr<const Chosen>(chosen), even,
          seed = options.seed](std::size_t i) -> Draw {
    const std::size_t n = chosen->order[i];
    const double u =
        even ? chosen->halton.b.at(n) : randomUnit(seed, Stage::pointPosition, 3 * n + 1);
    const double v =
        even ? chosen->halton.c.at(n) : randomUnit(seed, Stage::pointPosition, 3 * n + 2);
    return {chosen->points.triangleOf(n), u, v};
  };
}

DrawOf drawsOf(const SurfaceByArea& surface, const PointOptions& options) {
  if (options.rule == PointRule::perTriangle) return perTriangleDraws(surface, options);
  switch (options.sampler) {
    case PointSampler::uniform:
      break;
    case PointSampler::halton:
      return haltonDraws(surface, options.seed);
    case PointSampler::poisson:
      return poissonDraws(surface, options.count, options.seed);
  }
  return uniformDraws(surface, options.seed, Stage::pointPosition);
}

}  // namespace

PointSequence::PointSequence(const SurfaceByArea& surface, const PointOptions& options)
    : surface_(surface), count_(options.count), draw_(drawsOf(surface, options)) {}

SurfacePoints PointSequence::points(std::size_t first, std::size_t end) const {
  SurfacePoints points;
  points.positions.reserve(end - first);
  points.normals.reserve(end - first);
  points.neighbor.reserve(end - first);
  for (std::size_t i = first; i < end; ++i) {
    const Draw draw = draw_(i);
    const SurfacePoint point = surface_.pointAt(draw.triangle, draw.u, draw.v);
    points.positions.push_back(point.position);
    points.normals.push_back(point.normal);
    points.neighbor.push_back(point.neighbor);
  }
  return points;
}

Blocks<SurfacePoints> PointSequence::blocks() const {
  return {count_, [this](const auto& visit) {
            forEachBlock(count_,
                         [&](std::size_t first, std::size_t end) { visit(points(first, end)); });
          }};
}

std::uint64_t samplingMemory(const PointOptions& options) {
  constexpr std::uint64_t kPerPoisson = 700, kPerShuffled = 4;
  constexpr std::uint64_t kOfBlock = 80;  // the point, and as it is written
  const std::uint64_t held = options.rule == PointRule::perTriangle     ? kPerShuffled
                             : options.sampler == PointSampler::poisson ? kPerPoisson
                                                                        : 0;
  return held * options.count + kOfBlock * std::min(options.count, kSamplesPerBlock);
}

}  // namespace sherd
