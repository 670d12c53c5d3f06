// Where pieces are split: the shares that fragments are meant to get, and the planes of cracks.
#pragma once

#include <sherd/labels.h>

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <optional>
#include <span>
#include <vector>

namespace sherd {

/// Returns the shares of pieces that come of splitting one of size 1 again and again: which comes
/// next, and in what shares, is drawn by SplitOptions.
///   return  [pieces] in the order of a random permutation; their sum is 1
[[nodiscard]] std::vector<double> sharesOfSplits(const SplitOptions& options, std::size_t pieces,
                                                 std::uint64_t seed);

/// Moves shares towards their mean until none is below `least`.
///   least  at most 1 / shares
[[nodiscard]] std::vector<double> raisedTo(double least, std::vector<double> shares);

/// Returns how many of the first shares add up to nearest to a fraction of all, 1 to all but one.
[[nodiscard]] std::size_t firstOf(std::span<const double> shares, double fraction);

/// Distributes shares to components by their mass, at least one to each: the greatest first, each
/// to the component that lacks most.
///   shares  as many as components or more; at most the sum of `most`
///   mass    [components] of any unit, such as voxels
///   most    [components] shares, such as voxels
///   return  [components] the shares of each
[[nodiscard]] std::vector<std::vector<double>> sharesOfComponents(
    std::span<const double> shares, std::span<const double> mass,
    std::span<const std::uint64_t> most);

/// The voxels of a set: how many, and the sums of x, y, z and of xx, yy, zz, xy, xz, yz.
struct VoxelSums {
  std::int64_t count = 0;
  std::array<std::int64_t, 3> sum{};
  std::array<std::int64_t, 6> squares{};

  /// Adds sums that are relative to `low`.
  void add(const VoxelSums& other, const glm::ivec3& low);
  [[nodiscard]] glm::dvec3 mean() const;
  [[nodiscard]] glm::dmat3 covariance() const;  ///< voxels squared
};

/// Draws the normal of a crack through a piece: a random direction where the piece is as long as
/// it is wide; along its long axis, but for SplitOptions::tilt, where it is not.
///   item    of the random numbers
///   return  of any length but 0
[[nodiscard]] glm::dvec3 crackNormal(const glm::dmat3& covariance, const SplitOptions& options,
                                     const Anisotropy& anisotropy, std::uint64_t seed,
                                     std::uint64_t item);

/// Returns a direction in steps, each within 2^14.
[[nodiscard]] glm::ivec3 inSteps(const glm::dvec3& direction);

/// Voxels along a normal: where a share of them lies below.
class ProjectedVoxels {
 public:
  /// Of voxels whose mean and standard deviation along the normal are these.
  ProjectedVoxels(double mean, double deviation);

  /// Adds voxels, spread evenly about their mean.
  void add(double mean, double deviation, double voxels);

  /// Returns the position below which there is a fraction of the voxels.
  [[nodiscard]] double quantile(double fraction) const;

 private:
  static constexpr std::size_t kBins = 512;
  double low_, width_;  // of the first bin's start, and of a bin
  std::array<double, kBins> bins_{};
};

}  // namespace sherd
