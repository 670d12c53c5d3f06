// What a solid was made from: decides about points of space, whatever the voxels.
#pragma once

#include <sherd/coords.h>
#include <sherd/solid.h>

#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>

#include "mesh/search/triangle_tree.h"

namespace sherd {

class CanonicalSolid;

/// The inside of a mesh.  Thread-safe.
class SolidRegion {
 public:
  ///   sides          of the mesh's box, voxels; its low corner is that of voxel (0,0,0)
  ///   surface        bounds the region, or is the middle of a shell
  ///   contains       of a point
  ///   halfThickness  of a shell, voxels; else 0
  ///   firstClosing   this and later triangles of the surface's mesh close holes
  ///   isAsVoxels     whether the distances of the voxels are those of the region; not of a shell
  ///                  whose thickness is a number of voxels: the region is a layer then that every
  ///                  resolution has, and its half thickness 0
  SolidRegion(const glm::dvec3& sides, std::shared_ptr<const TriangleTree> surface,
              std::function<bool(const IndexPoint&)> contains, double halfThickness,
              bool isAsVoxels, std::uint32_t firstClosing = TriangleTree::kNone)
      : sides_(sides),
        surface_(std::move(surface)),
        contains_(std::move(contains)),
        halfThickness_(halfThickness),
        isAsVoxels_(isAsVoxels),
        firstClosing_(firstClosing) {}

  [[nodiscard]] const glm::dvec3& sides() const { return sides_; }

  [[nodiscard]] bool contains(const IndexPoint& point) const { return contains_(point); }

  /// Returns the solid of the whole mesh on which cracks are decided, or null.
  [[nodiscard]] const std::shared_ptr<CanonicalSolid>& canonical() const { return canonical_; }
  void setCanonical(std::shared_ptr<CanonicalSolid> canonical) {
    canonical_ = std::move(canonical);
  }

  [[nodiscard]] bool isAsVoxels() const { return isAsVoxels_; }

  /// Returns the triangles that bound the solid; null for shells, whose surface lies beside them.
  [[nodiscard]] const TriangleTree* boundary() const {
    return isAsVoxels_ && halfThickness_ == 0.0 ? surface_.get() : nullptr;
  }

  /// Returns whether the surface is less than `reach` away.
  [[nodiscard]] bool isWithin(const IndexPoint& point, double reach) const;

  /// Returns the point of the surface that is nearest.
  [[nodiscard]] IndexPoint onSurface(const IndexPoint& point) const;

  /// Returns whether the part of the surface that is nearest closes a hole.
  [[nodiscard]] bool isAtClosedHole(const IndexPoint& point) const;

  /// Returns where a ray first meets the surface.
  [[nodiscard]] std::optional<IndexPoint> firstHit(const IndexPoint& origin,
                                                   const glm::dvec3& direction) const;

 private:
  glm::dvec3 sides_;
  std::shared_ptr<const TriangleTree> surface_;
  std::function<bool(const IndexPoint&)> contains_;
  double halfThickness_;
  bool isAsVoxels_;
  std::uint32_t firstClosing_;
  std::shared_ptr<CanonicalSolid> canonical_{};
};

/// Returns the region of a solid without a mesh, such as one that is read back, whose surface is
/// known.  Points are inside where the solid's level set says so.
///   surface  world units; may have holes, where only the level set is known
[[nodiscard]] std::shared_ptr<const SolidRegion> regionOf(const Solid& solid, TriangleMesh surface);

}  // namespace sherd
