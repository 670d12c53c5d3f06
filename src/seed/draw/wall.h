// The walls of a solid: their middle, their thickness, and ways along them.
#pragma once

#include <sherd/seeds.h>
#include <sherd/solid.h>

#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

namespace sherd {

/// A place of a wall.
struct Wall {
  IndexPoint surface{};    ///< on the nearest surface
  glm::dvec3 normal{0.0};  ///< there, outward
  IndexPoint middle{};     ///< half way to the surface opposite
  double thickness = 0.0;  ///< to the surface opposite, along the normal, voxels
};

/// Looks for walls by the solid's level set, and its mesh where that bounds it.  Use it from one
/// thread.
class Walls {
 public:
  ///   solid  kept by reference
  explicit Walls(const Solid& solid);

  /// Returns the wall at a point near the solid, or nothing where it is thicker than `most` voxels,
  /// or the level set does not reach.
  [[nodiscard]] std::optional<Wall> at(const IndexPoint& point, double most) const;

  /// Returns the normal of the surface nearest to a point, outward; of length 0 where there is
  /// none.
  [[nodiscard]] glm::dvec3 normalAt(const IndexPoint& point) const;

  /// Walks along the surface, as straight as it is: each step goes on in the direction of the one
  /// before, and back onto the surface.
  ///   lengths  ascending, voxels
  ///   return   the points at these lengths; fewer where the surface ends or bends sharply
  [[nodiscard]] std::vector<IndexPoint> walk(const IndexPoint& from, const glm::dvec3& direction,
                                             const std::vector<double>& lengths) const;

 private:
  [[nodiscard]] double distance(const IndexPoint& point) const;
  [[nodiscard]] glm::dvec3 gradient(const IndexPoint& point) const;
  [[nodiscard]] std::optional<IndexPoint> towardsSurface(const IndexPoint& point) const;
  [[nodiscard]] std::optional<IndexPoint> onSurface(const IndexPoint& point) const;

  const Solid& solid_;
  std::function<float(const openvdb::Coord&)> valueAt_;  // empty without a level set
};

/// Moves a point into the middle of its wall, or nowhere where that is thicker than `most` voxels.
[[nodiscard]] IndexPoint wallMiddle(const Walls& walls, const IndexPoint& point, double most);

/// Returns below which thickness a wall is thin for this number of pieces, in voxels: the side of a
/// cube of a piece's volume.  Pieces of a thinner wall are wider than it is thick.
[[nodiscard]] double thinFor(const Solid& solid, std::size_t pieces);

/// Returns whether a solid is a vessel, a shell or a plate as far as its pieces are concerned: the
/// wall is thin at three quarters of 64 points inside, which are the same at every resolution; of a
/// solid without a mesh, of voxels.
[[nodiscard]] bool isThin(const Solid& solid, std::size_t pieces);

/// Returns what SeedsOn::automatic is for a solid, and other values as they are.
[[nodiscard]] SeedsOn resolved(SeedsOn on, const Solid& solid, std::size_t pieces);

}  // namespace sherd
