// Seed samplers: uniform, Halton, Gaussian, Poisson-disk.
#pragma once

#include <sherd/seeds.h>

#include <cstdint>
#include <functional>
#include <optional>

#include "seed/draw/candidates.h"
#include "seed/draw/density.h"
#include "seed/draw/draws.h"

namespace sherd {

/// Draws seeds with one sampler.  Each call continues the sequence of the previous one.
class SeedSampler {
 public:
  ///   candidates, density  kept by reference
  ///   density             not of Sampler::poisson
  SeedSampler(const Candidates& candidates, Sampler sampler, std::uint64_t seed,
              const DensityTest& density, const Progress* progress = nullptr)
      : candidates_(candidates),
        sampler_(sampler),
        seed_(seed),
        density_(density),
        progress_(progress) {}

  /// Adds `count` candidates; at least as many voxels must be free, and `count` be at least the
  /// number of components without a candidate.  Each of these gets one: once only as many are left,
  /// points in other components are refused.  So components need no number that would be another at
  /// another resolution.  Those too small to be met get a random voxel.
  ///
  /// Points are accepted by the density, but for components where it is 0 everywhere.
  ///   throws  Error(usage) the density is above 0 in too few voxels; Error(cancelled)
  void draw(std::size_t count, Chosen& chosen);

 private:
  using PointOf = std::function<glm::dvec3(std::uint64_t item)>;  // of the box; may lie beside it

  // Draws until `upTo` of `end` candidates are chosen.
  void drawEach(const PointOf& pointOf, std::size_t upTo, std::size_t end, Chosen& chosen);
  void drawUniform(std::size_t upTo, std::size_t end, Chosen& chosen);
  void drawAnew(std::size_t end, Chosen& chosen);
  void drawHalton(std::size_t end, Chosen& chosen);
  void addAny(std::size_t end, Chosen& chosen);
  // Whether the density accepts a point of the box.
  [[nodiscard]] bool isAccepted(const glm::dvec3& unit, std::uint64_t item);
  [[nodiscard]] Candidate denseCandidate(const Chosen& chosen);

  const Candidates& candidates_;
  Sampler sampler_;
  std::uint64_t seed_;
  const DensityTest& density_;
  const Progress* progress_;
  std::uint64_t next_ = 0;              // item of the next point of Halton's sequence, or dart
  std::uint64_t nextSeed_ = 0;          // number of the next seed with draws of its own
  std::uint64_t coverDraws_ = 1 << 18;  // left for components without a seed
  std::uint64_t refusals_ = 1 << 22;    // by the density, left before voxels are taken
  std::optional<DenseVoxels> dense_{};  // made when they are needed
  std::uint64_t nextVoxel_ = 0;         // item of the next voxel that is taken for want of a point
};

}  // namespace sherd
