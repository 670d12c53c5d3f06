// Samples points in the space around a mesh, with their signed distances.
#include <sherd/error.h>
#include <sherd/points.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <string>

#include "base/cancel_flag.h"
#include "base/half_float.h"
#include "base/random.h"
#include "base/text/formatted.h"
#include "points/distance_sequence.h"
#include "seed/draw/irwin_hall.h"

namespace sherd {
namespace {

double rounded(double value, SampleType type) {
  return type == SampleType::float16 ? roundedToHalf(value)
                                     : static_cast<double>(static_cast<float>(value));
}

double largestOf(SampleType type) { return type == SampleType::float16 ? kLargestHalf : 0x1p127; }

const DistanceOptions& checkedDistances(const DistanceOptions& options) {
  if (options.count > kMaxPoints) {
    throw Error(ErrorCode::usage, std::to_string(options.count) + " distance samples; at most " +
                                      std::to_string(kMaxPoints) + " are supported");
  }
  if (!(options.sigma > 0.0 && std::isfinite(options.sigma))) {
    throw Error(ErrorCode::usage, "the standard deviation of distance samples is " +
                                      formatted("%g", options.sigma) + ", expected above 0");
  }
  return options;
}

/// The mesh's box, widened on all sides.
Box boxAround(const TriangleMesh& mesh, const DistanceOptions& options) {
  Box box = bounds(mesh);
  const double wider = std::max(0.05 * longestSide(box), 3.0 * options.sigma);
  box.min -= wider;
  box.max += wider;
  return box;
}

/// Requires that coordinates and distances fit the sample type.  Normal draws reach six standard
/// deviations of up to 3 sigma from the surface.
void requireRoom(const Box& box, const DistanceOptions& options) {
  const glm::dvec3 far = glm::max(glm::abs(box.min), glm::abs(box.max));
  const double farthest = std::max({far.x, far.y, far.z, glm::length(box.max - box.min)});
  const double reach = farthest + 18.0 * options.sigma;
  constexpr double kSmallestNormalHalf = 0x1p-14;
  if (options.type == SampleType::float16 && longestSide(box) < kSmallestNormalHalf) {
    throw Error(ErrorCode::usage, "distance samples of a mesh " +
                                      formatted("%g", longestSide(box)) +
                                      " long lose their digits in float16; use float32");
  }
  if (reach < largestOf(options.type)) return;
  throw Error(ErrorCode::usage, "distance samples reach to " + formatted("%g", reach) +
                                    ", beyond the range of their type; use float32, or move the "
                                    "mesh nearer to the origin");
}

}  // namespace

DistanceSequence::DistanceSequence(const TriangleMesh& mesh, const DistanceOptions& options,
                                   const Progress* progress)
    : options_(checkedDistances(options)),
      progress_(progress),
      surface_(mesh),
      box_(boxAround(mesh, options)),
      distance_(mesh) {
  requireRoom(box_, options);
}

glm::dvec3 DistanceSequence::position(std::size_t i) const {
  const std::uint64_t seed = options_.seed;
  glm::dvec3 p;
  if (i % 2 == 0) {
    for (int axis = 0; axis < 3; ++axis) {
      const double share =
          randomUnit(seed, Stage::spacePosition, 3 * i + static_cast<std::uint64_t>(axis));
      p[axis] = box_.min[axis] + share * (box_.max[axis] - box_.min[axis]);
    }
  } else {
    const std::size_t t = surface_.triangleAt(randomUnit(seed, Stage::spaceSurface, 3 * i));
    // The mean of n uniforms has a standard deviation of 1 / sqrt(12 n), here 1 / 12.
    const double normal = 12.0 * meanOfUniforms(kNormalTerms, seed, Stage::spaceOffset, i);
    const SurfaceTriangle triangle = surface_.at(t);
    p = triangle.pointIn(randomUnit(seed, Stage::spaceSurface, 3 * i + 1),
                         randomUnit(seed, Stage::spaceSurface, 3 * i + 2)) +
        (i % 4 == 1 ? 1.0 : 3.0) * options_.sigma * normal * triangle.normal();
  }
  for (int axis = 0; axis < 3; ++axis) p[axis] = rounded(p[axis], options_.type);
  return p;
}

std::vector<glm::dvec3> DistanceSequence::positions(std::size_t first, std::size_t end) const {
  std::vector<glm::dvec3> positions;
  positions.reserve(end - first);
  for (std::size_t i = first; i < end; ++i) positions.push_back(position(i));
  return positions;
}

DistanceSamples DistanceSequence::samples(std::size_t first, std::size_t end) const {
  DistanceSamples samples{positions(first, end), {}, options_.type};
  samples.distances =
      signedDistances(distance_, samples.positions, first, options_.count, progress_);
  return samples;
}

DistanceBlocks DistanceSequence::blocks() const {
  const auto each = [this](const auto& visit) {
    forEachBlock(options_.count,
                 [&](std::size_t first, std::size_t end) { visit(samples(first, end)); });
  };
  const auto eachPositions = [this](const auto& visit) {
    forEachBlock(options_.count, [&](std::size_t first, std::size_t end) {
      throwIfCancelled(progress_);
      visit(positions(first, end));
    });
  };
  return {{options_.count, each}, eachPositions, options_.type};
}

DistanceSamples sampleDistances(const TriangleMesh& mesh, const DistanceOptions& options,
                                const Progress* progress) {
  if (checkedDistances(options).count == 0) return {{}, {}, options.type};
  return DistanceSequence(mesh, options, progress).samples(0, options.count);
}

}  // namespace sherd
