// Noise on the surfaces of fragments: SurfaceOptions::mismatch and scanNoise.
#pragma once

#include <sherd/fragments.h>

#include <cstdint>
#include <optional>

#include "mesh/self_affine_noise.h"
#include "mesh/surface_by_area.h"

namespace sherd {

/// Moves the vertices of fragments' meshes.  Lengths are those of the index space of `frame`, so
/// that meshes of an object that is moved or scaled move and scale with it.
class SurfaceNoise {
 public:
  ///   solid  its box gives the diagonal
  ///   seed   of the fracture
  SurfaceNoise(const SurfaceOptions& options, const Solid& solid, std::uint64_t seed);

  [[nodiscard]] bool isAny() const { return cracks_ || all_; }

  /// Returns over how many voxels from a contact's boundary the mismatch rises to all of it; 0
  /// without a mismatch.
  [[nodiscard]] double fadeVoxels() const;

  /// Moves the vertices of a fragment's mesh along the mean normals of their faces; topology and
  /// all else stay.
  ///   mesh  closed, with neighbors
  void move(TriangleMesh& mesh, std::uint16_t id) const;

  /// The noise of one fragment.
  struct OfPoints {
    std::uint16_t id = 0;
    GridFrame frame{};
    double fade = 0.0;  ///< fadeVoxels()
    std::optional<SelfAffineNoise> common{}, own{}, all{};
    double ownShare = 1.0, commonShare = 0.0;

    /// Moves a point of the fragment's surface along its normal, as move() does vertices, and
    /// rotates the normal.
    ///   toBoundary  from the contact's boundary, at most `fade`, voxels; its gradient has no unit.
    ///               Not read without a mismatch, or a neighbor
    void move(SurfacePoint& point, const SlopedValue& toBoundary) const;
  };
  [[nodiscard]] OfPoints ofPoints(std::uint16_t id) const;

 private:
  void moveCracks(TriangleMesh& mesh, std::uint16_t id) const;
  void moveAll(TriangleMesh& mesh, std::uint16_t id) const;

  GridFrame frame_;
  std::uint64_t seed_ = 0;
  std::optional<SelfAffineShape> cracks_, all_;  // voxels
  double ownShare_ = 1.0, commonShare_ = 0.0;    // of the height: their squares add up to 1
  std::optional<SelfAffineNoise> common_;
};

}  // namespace sherd
