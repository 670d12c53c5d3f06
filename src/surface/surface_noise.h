// Noise on the surfaces of fragments: SurfaceOptions::mismatch and scanNoise.
#pragma once

#include <sherd/fragments.h>

#include <cstdint>
#include <optional>

#include "mesh/self_affine_noise.h"

namespace sherd {

/// Moves the vertices of fragments' meshes.  Lengths are those of the index space of `frame`, so
/// that meshes of an object that is moved or scaled move and scale with it.
class SurfaceNoise {
 public:
  ///   solid  its box gives the diagonal; kept by reference
  ///   seed   of the fracture
  SurfaceNoise(const SurfaceOptions& options, const Solid& solid, std::uint64_t seed);

  [[nodiscard]] bool isAny() const { return cracks_ || all_; }

  /// Moves the vertices of a fragment's mesh along the mean normals of their faces; topology and
  /// all else stay.
  ///   mesh  closed, with neighbors
  void move(TriangleMesh& mesh, std::uint16_t id) const;

 private:
  void moveCracks(TriangleMesh& mesh, std::uint16_t id) const;
  void moveAll(TriangleMesh& mesh, std::uint16_t id) const;

  const GridFrame& frame_;
  std::uint64_t seed_ = 0;
  std::optional<SelfAffineShape> cracks_, all_;  // voxels
  double ownShare_ = 1.0, commonShare_ = 0.0;    // of the height: their squares add up to 1
  std::optional<SelfAffineNoise> common_;
};

}  // namespace sherd
