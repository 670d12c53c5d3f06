// The middle of thin walls, for voxels in and near them.
#pragma once

#include <sherd/progress.h>
#include <sherd/solid.h>

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace sherd {

/// For each voxel of a solid's leaf blocks, inside or just outside, the way to the middle of its
/// wall, along the wall's normal.  So all voxels on a straight line through the wall have the same
/// middle.
///
/// A normal is the main direction of those of the surface in the 8 voxels around, where there is
/// one: at rims, junctions and in solids without walls ways get shorter, down to 0.  Walls are
/// traced at every second voxel along each axis: between these, ways lead to the planes found
/// there, which in a flat wall is exact.
class WallMiddles {
 public:
  static constexpr int kSteps = 64;  ///< of a voxel

  ///   normals  of the solid, see wall_normals.h
  ///   most     voxels: walls thicker than this have no middle, and ways get shorter from 3/4 on
  ///   throws   Error(cancelled)
  WallMiddles(const Solid& solid, std::span<const glm::dmat3> normals, double most,
              const Progress* progress = nullptr);

  /// Of ways that are given.
  WallMiddles(std::shared_ptr<const LeafBlocks> blocks, std::vector<std::int16_t> ways);

  /// Returns the walls' thickness above which there is no middle that cracks follow, voxels: half
  /// of the side of a cube of the solid's volume.  It does not depend on the number of pieces, so
  /// that fractures of one solid can grow together.
  [[nodiscard]] static double mostOf(const Solid& solid);

  /// [leaves*512*3] ways in 1/64 voxel
  [[nodiscard]] std::span<const std::int16_t> ways() const { return ways_; }
  /// Returns the way from a voxel, by its index in the leaf blocks.
  [[nodiscard]] glm::ivec3 wayAt(std::size_t voxelIndex) const {
    const std::int16_t* const way = &ways_[3 * voxelIndex];
    return {way[0], way[1], way[2]};
  }
  /// Returns the longest way along any axis, in 1/64 voxel.
  [[nodiscard]] int reach() const { return reach_; }
  [[nodiscard]] const LeafBlocks& blocks() const { return *blocks_; }

 private:
  std::shared_ptr<const LeafBlocks> blocks_;
  std::vector<std::int16_t> ways_;
  int reach_ = 0;
};

/// What growth has to know of a solid's walls, found when it is first asked for: fractures of one
/// solid share it.  Callable from any thread.
class SolidWalls {
 public:
  explicit SolidWalls(Solid solid) : solid_(std::move(solid)) {}

  /// Returns whether these are the walls of a solid.
  [[nodiscard]] bool areOf(const Solid& solid) const { return solid.blocks == solid_.blocks; }

  /// Returns wallNormals, as long as this lives.
  [[nodiscard]] std::span<const glm::dmat3> normals();

  /// Returns the middles of walls up to WallMiddles::mostOf.
  ///   throws  Error(cancelled)
  [[nodiscard]] std::shared_ptr<const WallMiddles> middles(const Progress* progress);

  /// Bytes of what is found, for each leaf.
  static constexpr std::size_t kBytesOfALeaf = sizeof(glm::dmat3) + 512 * 3 * sizeof(std::int16_t);

 private:
  std::mutex found_;
  const Solid solid_;
  std::optional<std::vector<glm::dmat3>> normals_;
  std::shared_ptr<const WallMiddles> middles_;
};

/// Ways of a leaf's voxels and of those up to 8 around them.  Use it from one thread.
class WaysAround {
 public:
  ///   walls  kept by reference, or null: all ways are 0
  WaysAround(const WallMiddles* walls, const openvdb::Coord& origin);

  /// Returns a voxel in 1/64 voxel, moved to the middle of its wall.
  [[nodiscard]] glm::i64vec3 middleAt(const openvdb::Coord& voxel) const;

 private:
  const WallMiddles* walls_;
  openvdb::Coord low_;                  // of the 27 leaves
  std::array<std::uint32_t, 27> leaf_;  // x slowest
};

}  // namespace sherd
