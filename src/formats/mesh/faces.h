// The faces of a mesh, for formats that hold polygons.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "formats/mesh/piece_mesh.h"

namespace sherd {

/// Triangles, and polygons of the input whose triangles are all in the piece and uncut.  A polygon
/// has its corners in the input's order, from the first; of a flipped one the others follow
/// backwards.  It stays triangles where a reader would triangulate it in another way.
///
/// A corner is the number 3 * t + k: of triangle t corner k.
class Faces {
 public:
  using IsSame = std::function<bool(std::uint32_t, std::uint32_t)>;

  static constexpr std::size_t kAnyNumber = std::numeric_limits<std::size_t>::max();

  ///   isSame       whether the format holds the same for two corners, so that they can be one
  ///   mostCorners  of a face
  ///   cost         triangles * log(triangles) if the input has polygons
  Faces(const PieceMesh& piece, const IsSame& isSame, std::size_t mostCorners = kAnyNumber);

  [[nodiscard]] std::size_t count() const { return count_; }

  /// Returns the corners of the face that is listed at a triangle; none for triangles of a polygon
  /// that is listed at another of them.
  ///   own  overwritten; the result may refer to it
  [[nodiscard]] std::span<const std::uint32_t> at(std::uint32_t triangle,
                                                  std::array<std::uint32_t, 3>& own) const;

 private:
  static constexpr std::uint32_t kAlone = 0xffffffffu, kWithin = 0xfffffffeu;

  void join(const PieceMesh& piece, const IsSame& isSame, std::size_t mostCorners);

  std::uint32_t triangles_;
  std::size_t count_;
  std::vector<std::uint32_t>
      joined_{};  ///< [triangles] the polygon that begins with it, kAlone, or
                  ///< kWithin another triangle's polygon; empty: no polygon
  std::vector<std::uint32_t> ends_{}, corners_{};  ///< of polygons, one after another
};

}  // namespace sherd
