// Samples points on a mesh.
#include <sherd/error.h>
#include <sherd/points.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "base/random.h"
#include "mesh/surface_by_area.h"
#include "points/eliminate.h"
#include "points/sample_surface.h"
#include "seed/radical_inverse.h"

namespace sherd {
namespace {

/// A sampled point: a triangle, and a position in the unit square (see SurfaceTriangle::pointIn).
struct Draw {
  std::size_t triangle = 0;
  double u = 0.0, v = 0.0;
};

std::vector<Draw> drawUniform(const SurfaceByArea& surface, std::size_t count, std::uint64_t seed,
                              Stage stage) {
  std::vector<Draw> draws(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t t = surface.triangleAt(randomUnit(seed, stage, 3 * i));
    draws[i] = {t, randomUnit(seed, stage, 3 * i + 1), randomUnit(seed, stage, 3 * i + 2)};
  }
  return draws;
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

std::vector<Draw> drawHalton(const SurfaceByArea& surface, std::size_t count, std::uint64_t seed) {
  const Halton halton(seed);
  std::vector<Draw> draws(count);
  for (std::size_t i = 0; i < count; ++i) {
    draws[i] = {surface.triangleAt(halton.a.at(i)), halton.b.at(i), halton.c.at(i)};
  }
  return draws;
}

std::vector<Draw> drawPoisson(const SurfaceByArea& surface, std::size_t count, std::uint64_t seed) {
  const std::vector<Draw> draws =
      drawUniform(surface, count * kCandidatesPerPoint, seed, Stage::pointCandidate);
  std::vector<glm::dvec3> candidates;
  candidates.reserve(draws.size());
  for (const Draw& draw : draws) {
    candidates.push_back(surface.at(draw.triangle).pointIn(draw.u, draw.v));
  }
  std::vector<Draw> kept;
  kept.reserve(count);
  // Rounded to 24 bits, so that areas that were summed in another order give the same points.
  int exponent = 0;
  const double mantissa = std::frexp(surface.area(), &exponent);
  const double area = std::ldexp(std::round(std::ldexp(mantissa, 24)), exponent - 24);
  for (const std::size_t i : eliminated(candidates, count, area)) {
    kept.push_back(draws[i]);
  }
  return kept;
}

/// The triangle of each point by the paper's rule, ascending; at least `count` of them, as the
/// parts are rounded up.
std::vector<std::size_t> atLeastOneEach(const SurfaceByArea& surface, std::size_t count) {
  std::vector<std::size_t> triangles;
  for (std::size_t t = 0; t < surface.triangles(); ++t) {
    const double share = surface.area(t) / surface.area();
    if (share == 0.0) continue;
    const double own = std::ceil(share * static_cast<double>(count));
    triangles.insert(triangles.end(), std::max<std::size_t>(1, static_cast<std::size_t>(own)), t);
  }
  // Rounding of the shares can lose at most the last point.
  if (triangles.size() < count) triangles.resize(count, triangles.back());
  return triangles;
}

std::vector<Draw> drawPerTriangle(const SurfaceByArea& surface, const PointOptions& options) {
  const std::vector<std::size_t> triangles = atLeastOneEach(surface, options.count);
  std::vector<std::size_t> order(triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const Halton halton(options.seed);
  const bool even = options.sampler == PointSampler::halton;
  std::vector<Draw> draws(options.count);
  for (std::size_t i = 0; i < options.count; ++i) {  // a partial Fisher-Yates shuffle
    std::swap(order[i],
              order[i + randomBelow(order.size() - i, options.seed, Stage::pointShuffle, i)]);
    const std::size_t n = order[i], t = triangles[n];
    const double u =
        even ? halton.b.at(n) : randomUnit(options.seed, Stage::pointPosition, 3 * n + 1);
    const double v =
        even ? halton.c.at(n) : randomUnit(options.seed, Stage::pointPosition, 3 * n + 2);
    draws[i] = {t, u, v};
  }
  return draws;
}

std::vector<Draw> draw(const SurfaceByArea& surface, const PointOptions& options) {
  if (options.rule == PointRule::perTriangle) return drawPerTriangle(surface, options);
  switch (options.sampler) {
    case PointSampler::uniform:
      break;
    case PointSampler::halton:
      return drawHalton(surface, options.count, options.seed);
    case PointSampler::poisson:
      return drawPoisson(surface, options.count, options.seed);
  }
  return drawUniform(surface, options.count, options.seed, Stage::pointPosition);
}

}  // namespace

void checkPointOptions(const PointOptions& options) {
  if (options.count > kMaxPoints) {
    throw Error(ErrorCode::usage, std::to_string(options.count) + " points; at most " +
                                      std::to_string(kMaxPoints) + " are supported");
  }
  if (options.rule == PointRule::perTriangle && options.sampler == PointSampler::poisson) {
    throw Error(ErrorCode::usage,
                "the point sampler poisson does not support the rule per-triangle; use the rule "
                "area, or the sampler uniform or halton");
  }
}

SurfacePoints samplePoints(const SurfaceByArea& surface, const PointOptions& options) {
  SurfacePoints points;
  points.positions.reserve(options.count);
  points.normals.reserve(options.count);
  points.neighbor.reserve(options.count);
  for (const Draw& d : draw(surface, options)) {
    const SurfaceTriangle triangle = surface.at(d.triangle);
    points.positions.push_back(triangle.pointIn(d.u, d.v));
    points.normals.push_back(triangle.normal());
    points.neighbor.push_back(triangle.neighbor);
  }
  return points;
}

SurfacePoints samplePoints(const TriangleMesh& mesh, const PointOptions& options) {
  checkPointOptions(options);
  if (options.count == 0) return {};
  return samplePoints(SurfaceByArea(mesh), options);
}

PointOptions pointOptionsOf(PointOptions options, int id) {
  options.seed = randomBits(options.seed, Stage::pointFragment, static_cast<std::uint64_t>(id));
  return options;
}

std::vector<std::size_t> shareOut(std::size_t total, std::span<const double> areas) {
  const double sum = std::accumulate(areas.begin(), areas.end(), 0.0);
  std::vector<std::size_t> counts;
  std::vector<std::pair<double, std::size_t>> remainders;  // negated: the largest sorts first
  std::size_t given = 0;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double part = areas[i] / sum * static_cast<double>(total), whole = std::floor(part);
    counts.push_back(std::min(static_cast<std::size_t>(whole), total - given));
    given += counts.back();
    remainders.emplace_back(whole - part, i);
  }
  std::sort(remainders.begin(), remainders.end());
  for (std::size_t k = 0; given < total; ++k, ++given) ++counts[remainders[k].second];
  return counts;
}

}  // namespace sherd
