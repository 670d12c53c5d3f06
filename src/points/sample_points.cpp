// Samples points on a mesh.
#include <sherd/error.h>
#include <sherd/points.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "base/random.h"
#include "mesh/surface_by_area.h"
#include "points/point_sequence.h"
#include "points/sample_surface.h"

namespace sherd {

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
  return PointSequence(surface, options).points(0, options.count);
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
