// Distance samples, any of which can be made without those before it.
#pragma once

#include <sherd/points.h>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "mesh/search/mesh_distance.h"
#include "mesh/surface_by_area.h"
#include "points/blocks.h"

namespace sherd {

/// The samples around a mesh in their order.  Keeps a reference to the mesh.
class DistanceSequence {
 public:
  ///   options   count > 0
  ///   progress  or null; kept
  ///   throws    as sampleDistances
  DistanceSequence(const TriangleMesh& mesh, const DistanceOptions& options,
                   const Progress* progress);

  /// Returns the positions of samples first..end-1.
  [[nodiscard]] std::vector<glm::dvec3> positions(std::size_t first, std::size_t end) const;

  /// Returns these samples.
  [[nodiscard]] DistanceSamples samples(std::size_t first, std::size_t end) const;

  /// Keeps a reference to this.
  [[nodiscard]] DistanceBlocks blocks() const;

 private:
  [[nodiscard]] glm::dvec3 position(std::size_t i) const;

  DistanceOptions options_;
  const Progress* progress_;
  SurfaceByArea surface_;
  Box box_;  // of samples that are uniform in space
  MeshDistance distance_;
};

/// Returns [points] signed distances.  Reports the progress of points first..first+points of `all`.
[[nodiscard]] std::vector<double> signedDistances(const MeshDistance& surface,
                                                  std::span<const glm::dvec3> points,
                                                  std::size_t first, std::size_t all,
                                                  const Progress* progress);

}  // namespace sherd
