// Walls are traced along normals through the level set, which is a distance: steps of its value.
#include "voxelize/wall_samples.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "base/cancel_flag.h"
#include "voxelize/distance.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

double trace(const glm::dmat3& m) { return m[0][0] + m[1][1] + m[2][2]; }

// The direction across a wall, and how sure it is, 0..1.
struct Across {
  glm::dvec3 normal{0.0};
  double weight = 0.0;
};

//   normals  sum of n n^T of the surface near
Across acrossOf(const glm::dmat3& normals) {
  const double all = trace(normals);
  if (!(all > 0.0)) return {};
  // To the 32nd power a matrix has the main direction in every column.
  glm::dmat3 power = normals / all;
  for (int i = 0; i < 5; ++i) {
    power = power * power;
    power /= trace(power);
  }
  int axis = 0;
  for (int i = 1; i < 3; ++i) axis = power[i][i] > power[axis][axis] ? i : axis;
  const glm::dvec3 normal = glm::normalize(power[axis]);
  // The mean square of the cosine: 1 in a plate, 0.5 at the edge of a block, 1/3 in a ball.  In
  // tubes and shells as narrow as 8 voxels about it is 0.75.
  constexpr double kLeast = 0.55, kSure = 0.7;
  const double share = glm::dot(normal, normals * normal) / all;
  return {normal, std::clamp((share - kLeast) / (kSure - kLeast), 0.0, 1.0)};
}

// The level set of a solid, in voxels, linear between the voxels' centers.  For one thread.
class Distances {
 public:
  explicit Distances(const Solid& solid)
      : valueAt_(valuesOf(solid.distance)), perVoxel_(1.0 / solid.frame.voxelSize) {}

  double ofVoxel(const openvdb::Coord& voxel) const { return perVoxel_ * valueAt_(voxel); }

  double at(const glm::dvec3& point) const {
    const glm::dvec3 low = glm::floor(point), f = point - low;
    const openvdb::Coord corner(static_cast<int>(low.x), static_cast<int>(low.y),
                                static_cast<int>(low.z));
    double sum = 0.0;
    for (int k = 0; k < 8; ++k) {
      const int x = k >> 2, y = k >> 1 & 1, z = k & 1;
      const double share = (x ? f.x : 1.0 - f.x) * (y ? f.y : 1.0 - f.y) * (z ? f.z : 1.0 - f.z);
      if (share > 0.0) sum += share * ofVoxel(corner.offsetBy(x, y, z));
    }
    return sum;
  }

  // Returns how far a direction leads from a point inside to the surface; nothing beyond `most`.
  std::optional<double> toSurface(const glm::dvec3& from, const glm::dvec3& direction,
                                  double most) const {
    double length = 0.0, value = at(from);
    while (value < 0.0) {
      if (length > most) return {};
      const double step = std::max(-value, kLeastStep);
      const double next = at(from + (length + step) * direction);
      if (next >= 0.0) return length + step * value / (value - next);
      length += step;
      value = next;
    }
    return length;
  }

  // The same from a point outside, to where the direction leads inside.
  std::optional<double> toInside(const glm::dvec3& from, const glm::dvec3& direction,
                                 double most) const {
    double length = 0.0, value = at(from);
    while (value >= 0.0) {
      if (length > most) return {};
      const double step = std::max(value, kLeastStep);
      const double next = at(from + (length + step) * direction);
      if (next < 0.0) return length + step * value / (value - next);
      length += step;
      value = next;
    }
    return length;
  }

  glm::dvec3 slope(const openvdb::Coord& voxel) const {
    glm::dvec3 slope(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      openvdb::Coord low = voxel, high = voxel;
      --low[axis];
      ++high[axis];
      slope[axis] = ofVoxel(high) - ofVoxel(low);
    }
    return slope;
  }

 private:
  static constexpr double kLeastStep = 0.25;
  std::function<float(const openvdb::Coord&)> valueAt_;
  double perVoxel_;
};

// Returns the way from a voxel to the middle of its wall, and the wall's thickness, voxels.
struct Way {
  glm::dvec3 way{0.0};
  double thickness = 0.0;
};

std::optional<Way> wayOf(const Distances& distances, const openvdb::Coord& voxel, double value,
                         const glm::dvec3& normal, double most) {
  const glm::dvec3 at(voxel.x(), voxel.y(), voxel.z());
  if (value < 0.0) {
    const std::optional<double> up = distances.toSurface(at, normal, most);
    if (!up) return {};
    const std::optional<double> down = distances.toSurface(at, -normal, most);
    if (!down) return {};
    return Way{0.5 * (*up - *down) * normal, *up + *down};
  }
  constexpr double kFarthest = 3.0, kStart = 0.5;
  const glm::dvec3 inward = glm::dot(distances.slope(voxel), normal) > 0.0 ? -normal : normal;
  const std::optional<double> in = distances.toInside(at, inward, kFarthest);
  if (!in) return {};
  // Just behind the surface the level set is 0, within rounding.
  const std::optional<double> rest =
      distances.toSurface(at + (*in + kStart) * inward, inward, most);
  if (!rest) return {};
  const double thickness = kStart + *rest;
  return Way{(*in + 0.5 * thickness) * inward, thickness};
}

// Sums of normals of a leaf and those around it, and their mean at its voxels.
class NormalsAround {
 public:
  NormalsAround(const LeafBlocks& blocks, std::span<const glm::dmat3> normals, std::size_t leaf) {
    for (int k = 0; k < 27; ++k) {
      const openvdb::Coord offset(8 * (k / 9 - 1), 8 * (k / 3 % 3 - 1), 8 * (k % 3 - 1));
      const std::uint32_t around = k == 13 ? static_cast<std::uint32_t>(leaf)
                                           : findLeaf(blocks, blocks.origins[leaf] + offset);
      near_[static_cast<std::size_t>(k)] =
          around == LeafBlocks::kNone ? glm::dmat3(0.0) : normals[around];
      hasNormals_ = hasNormals_ || trace(near_[static_cast<std::size_t>(k)]) > 0.0;
    }
  }

  bool hasNormals() const { return hasNormals_; }

  // Linear between the leaves' centers.
  glm::dmat3 at(int x, int y, int z) const {
    glm::dmat3 sum(0.0);
    const std::array<int, 3> offset{x, y, z};
    std::array<int, 3> low{};
    std::array<double, 3> share{};  // of the higher leaf
    for (std::size_t i = 0; i < 3; ++i) {
      const double position = (offset[i] - 3.5) / 8.0;
      low[i] = position < 0.0 ? 0 : 1;
      share[i] = position < 0.0 ? 1.0 + position : position;
    }
    for (int k = 0; k < 8; ++k) {
      const int i = k >> 2, j = k >> 1 & 1, l = k & 1;
      const double weight = (i ? share[0] : 1.0 - share[0]) * (j ? share[1] : 1.0 - share[1]) *
                            (l ? share[2] : 1.0 - share[2]);
      sum += weight *
             near_[static_cast<std::size_t>(9 * (low[0] + i) + 3 * (low[1] + j) + low[2] + l)];
    }
    return sum;
  }

 private:
  std::array<glm::dmat3, 27> near_;
  bool hasNormals_ = false;
};

// Returns the sample at a voxel, of a distance to the surface.
WallSample sampleOf(const Distances& distances, const openvdb::Coord& voxel, double value,
                    const glm::dmat3& normals, double most) {
  WallSample sample{.isKnown = true};
  const Across across = acrossOf(normals);
  if (across.weight == 0.0) return sample;
  const std::optional<Way> way = wayOf(distances, voxel, value, across.normal, most);
  if (!way) return sample;
  const double thin = std::clamp(4.0 * (1.0 - way->thickness / most), 0.0, 1.0);
  sample.normal = across.normal;
  sample.toMiddle = static_cast<float>(glm::dot(way->way, across.normal));
  sample.weight = static_cast<float>(across.weight * thin);
  return sample;
}

void sampleLeaf(const LeafBlocks& blocks, const Distances& distances, const NormalsAround& normals,
                std::size_t leaf, double most, std::span<WallSample> samples) {
  for (int k = 0; k < kWallSamples; ++k) {
    const int x = 2 * (k >> 4), y = 2 * (k >> 2 & 3), z = 2 * (k & 3);
    const openvdb::Coord voxel = blocks.origins[leaf].offsetBy(x, y, z);
    const double value = distances.ofVoxel(voxel);
    if (value > kFarthestFromWall) continue;
    samples[leaf * kWallSamples + static_cast<std::size_t>(k)] =
        sampleOf(distances, voxel, value, normals.at(x, y, z), most);
  }
}

}  // namespace

std::vector<WallSample> wallSamples(const Solid& solid, std::span<const glm::dmat3> normals,
                                    double most, const Progress* progress) {
  const LeafBlocks& blocks = *solid.blocks;
  std::vector<WallSample> samples(blocks.count() * kWallSamples);
  CancelFlag stop(progress);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.count(), 16), [&](const auto& range) {
    if (stop.isSet()) return;
    const Distances distances(solid);
    for (std::size_t leaf = range.begin(); leaf < range.end(); ++leaf) {
      const NormalsAround around(blocks, normals, leaf);
      if (around.hasNormals()) sampleLeaf(blocks, distances, around, leaf, most, samples);
    }
  });
  stop.throwIfSet();
  return samples;
}

}  // namespace sherd
