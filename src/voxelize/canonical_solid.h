// A solid on which cracks are decided, whatever the voxels that they are made of.
#pragma once

#include <sherd/progress.h>
#include <sherd/solid.h>

#include <memory>
#include <mutex>

namespace sherd {

/// The solid of a mesh at a resolution that depends on the mesh alone, made when it is first asked
/// for: splits and the patterns of impacts are decided on it, so that they are the same at every
/// resolution.  Callable from any thread.
class CanonicalSolid {
 public:
  /// The resolution, and the highest one, of meshes with walls that the first does not resolve.
  static constexpr int kResolution = 96, kMostResolution = 192;

  ///   mesh  its vertices and triangles are copied
  CanonicalSolid(const TriangleMesh& mesh, SolidOptions options);

  /// Returns the solid, or null where a solid of the same mesh has its voxels, is filled otherwise,
  /// or where it would have none.
  ///   throws  Error(cancelled)
  [[nodiscard]] std::shared_ptr<const Solid> otherThan(const Solid& solid,
                                                       const Progress* progress);

 private:
  [[nodiscard]] std::shared_ptr<const Solid> made(const Progress* progress) const;

  std::mutex making_;
  const double longest_;  // side of the mesh's box
  TriangleMesh mesh_;     // until the solid is made
  const SolidOptions options_;
  bool isMade_ = false;
  std::shared_ptr<const Solid> solid_;
};

/// Returns the solid on which cracks through another are decided, or null: it is that one itself.
///   throws  Error(cancelled)
[[nodiscard]] std::shared_ptr<const Solid> canonicalOf(const Solid& solid,
                                                       const Progress* progress);

/// As voxelize(), but an open mesh that `options` leave to Fill::automatic is made a shell after a
/// share of the usual work.
[[nodiscard]] Solid voxelizeWithin(const TriangleMesh& mesh, const SolidOptions& options,
                                   double workShare, const Progress* progress = nullptr);

/// Positions in the voxels of one solid, in those of another of the same mesh.
struct VoxelScale {
  double ratio = 1.0;      ///< of the sizes of their voxels
  glm::dvec3 offset{0.0};  ///< of their low corners

  ///   from, to  of one mesh: their low corners are that of its box
  [[nodiscard]] static VoxelScale between(const Solid& from, const Solid& to) {
    return {from.frame.voxelSize / to.frame.voxelSize};
  }

  /// The same of solids anywhere.
  [[nodiscard]] static VoxelScale between(const GridFrame& from, const GridFrame& to) {
    const auto low = [](const GridFrame& frame) { return frame.origin - 0.5 * frame.voxelSize; };
    return {from.voxelSize / to.voxelSize, (low(from) - low(to)) / to.voxelSize};
  }

  /// Returns a position in index space.  It does not depend on where the mesh is.
  [[nodiscard]] glm::dvec3 position(const glm::dvec3& p) const {
    return ratio * p + 0.5 * (ratio - 1.0) + offset;
  }
};

}  // namespace sherd
