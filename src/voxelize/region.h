// What a solid was made from: decides about points of space, whatever the voxels.
#pragma once

#include <sherd/solid.h>

#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>

#include "mesh/triangle_tree.h"

namespace sherd {

/// A shell around a mesh, or none.
struct ShellOfRegion {
  double halfThickness = 0.0;  ///< voxels; 0: no shell
  bool inVoxels =
      false;  ///< the thickness is a number of voxels, another length at each resolution
};

/// The inside of a mesh.  Points are in the index space of the solid.  Thread-safe.
class SolidRegion {
 public:
  ///   sides     of the mesh's box, voxels; its low corner is that of voxel (0,0,0)
  ///   surface   bounds the region, or is the middle of a shell
  ///   contains  of a point
  SolidRegion(const glm::dvec3& sides, std::shared_ptr<const TriangleTree> surface,
              std::function<bool(const glm::dvec3&)> contains, ShellOfRegion shell)
      : sides_(sides),
        surface_(std::move(surface)),
        contains_(std::move(contains)),
        shell_(shell) {}

  [[nodiscard]] const glm::dvec3& sides() const { return sides_; }

  [[nodiscard]] bool contains(const glm::dvec3& point) const { return contains_(point); }

  /// Returns whether the voxels' distances are those of the region.
  [[nodiscard]] bool isAsVoxels() const { return !shell_.inVoxels; }

  /// Returns whether the surface is less than `reach` away; for a shell in voxels, whose layer is
  /// thin, whether it contains the point.
  [[nodiscard]] bool isWithin(const glm::dvec3& point, double reach) const;

  /// Returns the point of the surface that is nearest; of a shell in voxels, of its middle.
  [[nodiscard]] glm::dvec3 onSurface(const glm::dvec3& point) const;

  /// Returns where a ray first meets the surface.
  [[nodiscard]] std::optional<glm::dvec3> firstHit(const glm::dvec3& origin,
                                                   const glm::dvec3& direction) const;

 private:
  glm::dvec3 sides_;
  std::shared_ptr<const TriangleTree> surface_;
  std::function<bool(const glm::dvec3&)> contains_;
  ShellOfRegion shell_;
};

}  // namespace sherd
