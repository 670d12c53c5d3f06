// The voxels that seeds may take, and the points of space that choose them.
#pragma once

#include <sherd/seeds.h>

#include <cstdint>
#include <functional>
#include <glm/ext/vector_int3_sized.hpp>
#include <optional>
#include <unordered_set>
#include <vector>

#include "seed/draw/voxel_index.h"
#include "seed/draw/wall.h"

namespace sherd {

/// A point of the solid for a seed, and the voxel that it takes.
struct Candidate {
  std::optional<VoxelKey> key{};  ///< none where the voxels do not resolve the solid
  glm::ivec3 shift{0};            ///< as in Seed
  glm::i64vec3 inSpace{};  ///< the point in steps of 2^-20 of the box's longest side, from its low
                           ///< corner: the same at any resolution
};

/// The candidates chosen so far, on distinct voxels, in order; and the components without one.
class Chosen {
 public:
  ///   components  kept by reference
  explicit Chosen(const VoxelComponents& components)
      : components_(components), isSeeded_(components.count()), unseeded_(components.count()) {}

  [[nodiscard]] std::size_t size() const { return all_.size(); }
  [[nodiscard]] const std::vector<Candidate>& all() const { return all_; }
  [[nodiscard]] bool has(VoxelKey key) const { return taken_.contains(key); }

  /// Returns the number of components without a candidate.
  [[nodiscard]] std::size_t unseeded() const { return unseeded_; }
  [[nodiscard]] bool isSeeded(std::uint32_t component) const { return isSeeded_[component]; }
  [[nodiscard]] const VoxelComponents& components() const { return components_; }

  /// Returns whether a candidate may be one of `end`: it has a voxel, and each component without
  /// one needs one of those that are left.
  [[nodiscard]] bool mayTake(const Candidate& candidate, std::size_t end) const {
    if (!candidate.key) return false;
    return end - size() > unseeded_ || !isSeeded_[components_.at(*candidate.key)];
  }

  /// Adds a candidate; returns false if it has no voxel or that is already chosen.
  bool add(const Candidate& candidate) {
    if (!candidate.key || !taken_.insert(*candidate.key).second) return false;
    all_.push_back(candidate);
    const std::uint32_t component = components_.at(*candidate.key);
    unseeded_ -= isSeeded_[component] ? 0 : 1;
    isSeeded_[component] = true;
    return true;
  }

 private:
  const VoxelComponents& components_;
  std::vector<Candidate> all_;
  std::unordered_set<VoxelKey> taken_;
  std::vector<bool> isSeeded_;  // [component]
  std::size_t unseeded_;
};

/// Finds candidates at points of space.  Whether a point is inside is decided by the mesh, so that
/// solids of one mesh at several resolutions accept the same points; without a mesh by the voxels.
/// Use it from one thread.
class Candidates {
 public:
  /// solid, voxels  kept by reference
  ///   voxels  that seeds may take: the inside voxels, or those of the surface
  ///   thin    thickness in voxels up to which SeedsOn::wall moves seeds to the middle of a wall
  Candidates(const Solid& solid, const VoxelIndex& voxels, SeedsOn on, double thin = 0.0);

  /// Returns the candidate at a point of the box, if the solid is there: inside it, and with
  /// SeedsOn::surface within 1/256 of the box's longest side of the surface, onto which it moves.
  /// With SeedsOn::wall it moves to the middle of a thin wall.
  ///   unit  0..1 along each axis of the box
  [[nodiscard]] std::optional<Candidate> inBox(const glm::dvec3& unit) const;

  /// Returns a point of the box in index space.
  [[nodiscard]] glm::dvec3 pointInBox(const glm::dvec3& unit) const { return low_ + unit * sides_; }

  /// The same at a point in index space.
  [[nodiscard]] std::optional<Candidate> at(const glm::dvec3& point) const;

  /// Returns the candidate at a voxel's center.
  [[nodiscard]] Candidate ofVoxel(VoxelKey key) const;

  /// Returns the voxels of the candidates.
  [[nodiscard]] const VoxelIndex& voxels() const { return voxels_; }

  /// Returns the sides of the mesh's box, voxels; without a mesh those of the solid's.
  [[nodiscard]] const glm::dvec3& sides() const { return sides_; }

  /// Returns the sides of the box in the steps of Candidate::inSpace.
  [[nodiscard]] glm::i64vec3 stepsOfBox() const;

  /// Returns how many draws in the box find a candidate, with a good reserve.
  [[nodiscard]] std::uint64_t drawsForOne() const;

 private:
  [[nodiscard]] bool isSolid(const glm::dvec3& point) const;
  [[nodiscard]] std::optional<Candidate> near(const glm::dvec3& point,
                                              const glm::i64vec3& inSpace) const;

  const Solid& solid_;
  const VoxelIndex& voxels_;
  SeedsOn on_;
  glm::dvec3 low_{}, sides_{};  // of the box, index space
  double longest_ = 0.0;
  std::function<float(const openvdb::Coord&)> distanceAt_;  // empty without a mesh
  double thin_;
  std::optional<Walls> walls_;  // with SeedsOn::wall
};

/// Returns a point's shift from a voxel's center, limited to the voxel's cube.
[[nodiscard]] glm::ivec3 shiftOf(const glm::dvec3& point, const openvdb::Coord& voxel);

}  // namespace sherd
