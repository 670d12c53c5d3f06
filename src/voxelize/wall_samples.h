// Thin walls at every second voxel.
#pragma once

#include <sherd/progress.h>
#include <sherd/solid.h>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// A wall at a voxel inside it or just outside.
struct WallSample {
  glm::vec3 normal{0.0F};  ///< across the wall, unit, either way
  float toMiddle = 0.0F;   ///< along the normal to half way between both surfaces, voxels
  float weight = 0.0F;     ///< 0..1: how surely there is a thin wall; 0: no normal and no middle
  bool isKnown = false;    ///< whether the voxel is near enough to have been looked at
};

constexpr int kWallSamples = 64;           ///< of a leaf: x, y, z = 0, 2, 4, 6, x slowest
constexpr double kFarthestFromWall = 1.8;  ///< voxels: cells at the surface have corners within a
                                           ///< voxel's diagonal of it

/// Finds the walls of a solid.
///   normals  of the solid, see wall_normals.h
///   most     voxels: walls thicker than this have weight 0, and weights fall from 3/4 on
///   return   [leaves*64]
///   throws   Error(cancelled)
///   source   Hart, Sphere Tracing: A Geometric Method for the Antialiased Ray Tracing of Implicit
///            Surfaces, 1996 (steps of the distance)
[[nodiscard]] std::vector<WallSample> wallSamples(const Solid& solid,
                                                  std::span<const glm::dmat3> normals, double most,
                                                  const Progress* progress);

}  // namespace sherd
