// Integer tables for metrics, steps and anisotropy.
#include "grow/fields/metric.h"

#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numeric>

namespace sherd {
namespace {

static_assert(kSeedSteps == 1 << SHERD_SEED_BITS);

// Returns the matrix that divides lengths along the direction by 1 + strength.
glm::dmat3 stretching(const Anisotropy& anisotropy) {
  if (anisotropy.strength == 0.0) return glm::dmat3(1.0);
  const double length = glm::length(anisotropy.direction);
  if (!(length > 0.0) || !std::isfinite(length)) {
    throw Error(ErrorCode::usage, "the grain needs a direction other than 0,0,0");
  }
  if (!(anisotropy.strength >= -0.75 && anisotropy.strength <= 9.0)) {
    throw Error(ErrorCode::usage, "the grain's strength must lie in -0.75..9");
  }
  const glm::dvec3 g = anisotropy.direction / length;
  return glm::dmat3(1.0) - (1.0 - 1.0 / (1.0 + anisotropy.strength)) * glm::outerProduct(g, g);
}

void add(Steps& steps, const glm::ivec3& d, double weight) {
  const auto whole = static_cast<std::int32_t>(std::max(1.0, std::floor(weight + 0.5)));
  steps.step.push_back({d.x, d.y, d.z, whole});
  // The two voxels that a long step crosses: half of it, rounded towards its start and its end.
  for (const bool up : {false, true}) {
    std::int32_t packed = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int half = up ? (d[axis] + (d[axis] > 0) - (d[axis] < 0)) / 2 : d[axis] / 2;
      packed = packed << 4 | (half + 4);
    }
    steps.within.push_back(packed);
  }
}

void setLeastWeight(Steps& steps) {
  std::int32_t least = steps.step.front().w;
  for (const Int4& step : steps.step) least = std::min(least, step.w);
  steps.leastWeight = static_cast<std::uint32_t>(least);
}

}  // namespace

sherd_metric metricFor(Metric metric, const Anisotropy& anisotropy) {
  sherd_metric out{};
  out.kind = metric == Metric::euclidean   ? SHERD_EUCLIDEAN
             : metric == Metric::chebyshev ? SHERD_CHEBYSHEV
                                           : SHERD_MANHATTAN;
  const bool isIsotropic = anisotropy.strength == 0.0;
  const glm::dmat3 matrix = stretching(anisotropy);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const double entry = matrix[column][row] * (isIsotropic ? 1 : SHERD_ANISOTROPY_ONE);
      out.row[3 * row + column] = static_cast<int>(std::floor(entry + 0.5));
    }
  }
  if (!isIsotropic)
    out.shift = metric == Metric::euclidean ? 12 : 6;  // SHERD_ANISOTROPY_ONE or its square
  return out;
}

glm::i64vec3 stretched(const sherd_metric& metric, const glm::i64vec3& steps) {
  glm::i64vec3 out;
  for (int i = 0; i < 3; ++i) {
    out[i] = metric.row[3 * i] * steps.x + metric.row[3 * i + 1] * steps.y +
             metric.row[3 * i + 2] * steps.z;
  }
  return out;
}

Steps layerSteps(int neighborhood, const Anisotropy& anisotropy) {
  const glm::dmat3 matrix = stretching(anisotropy);
  Steps steps;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const int axes = std::abs(x) + std::abs(y) + std::abs(z);
        if (axes == 0 || (neighborhood == 6 && axes > 1)) continue;
        const glm::dvec3 d = matrix * glm::dvec3(x, y, z);
        const double length = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
        add(steps, {x, y, z}, anisotropy.strength == 0.0 ? 1.0 : 8.0 * length);
      }
    }
  }
  setLeastWeight(steps);
  return steps;
}

Steps chamferSteps(const Anisotropy& anisotropy) {
  const glm::dmat3 matrix = stretching(anisotropy);
  Steps steps;
  for (const int reach : {1, 2}) {
    for (int x = -2; x <= 2; ++x) {
      for (int y = -2; y <= 2; ++y) {
        for (int z = -2; z <= 2; ++z) {
          const int furthest = std::max({std::abs(x), std::abs(y), std::abs(z)});
          if (furthest != reach || std::gcd(std::gcd(x, y), z) != 1) continue;
          add(steps, {x, y, z}, 16.0 * glm::length(matrix * glm::dvec3(x, y, z)));
        }
      }
    }
  }
  setLeastWeight(steps);
  return steps;
}

}  // namespace sherd
