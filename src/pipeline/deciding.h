// The solid on which splits are decided, prepared as the one that is broken.
#pragma once

#include <sherd/fracture.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "voxelize/wall_middles.h"

namespace sherd {

/// A solid of the same mesh as another.
struct OtherSolid {
  Solid solid;                             ///< without small components
  VoxelComponents components;              ///< of the solid
  std::shared_ptr<SolidWalls> walls;       ///< of the solid
  std::vector<std::uint32_t> component{};  ///< [components of the other] those of this one
  double side = 0.0;                       ///< of what decidingSolid made, world units

  /// Returns whether the voxels resolve so many pieces.
  [[nodiscard]] bool resolves(std::size_t pieces) const {
    constexpr std::uint64_t kLeastVoxels = 64;  // of a piece, on average
    return solid.voxels >= kLeastVoxels * pieces;
  }
};

/// Returns a solid of a mesh on which cracks through another solid of it are decided, or null where
/// its voxels would not resolve the mesh, or not its components.
///   solid  of that mesh, in whose place it decides; its low corner is that of the other's voxels
///   mesh   closed, world units; without attributes
///   side   world units: the solid has CanonicalSolid::kResolution voxels along it, or twice as
///   many throws  Error(device); Error(cancelled)
[[nodiscard]] std::optional<OtherSolid> decidingSolid(const Solid& solid,
                                                      const VoxelComponents& components,
                                                      const TriangleMesh& mesh, double side,
                                                      Device& device, const Progress* progress);

/// The solid on which splits through a prepared one are decided, found when it is first asked for.
/// Callable from any thread.
class DecidingSolids {
 public:
  /// Returns the solid, or null where splits are decided on the prepared one itself: it is at the
  /// canonical resolution, has neither a mesh nor a level set of more voxels, or the other has
  /// other components.
  ///   throws  Error(device); Error(cancelled)
  [[nodiscard]] const OtherSolid* of(const Solid& solid, const VoxelComponents& components,
                                     Device& device, const Progress* progress);

 private:
  std::mutex finding_;
  bool isFound_ = false;
  std::optional<OtherSolid> found_;
};

}  // namespace sherd
