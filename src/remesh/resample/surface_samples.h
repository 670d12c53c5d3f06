// Random points of a mesh, apart from each other.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "remesh/resample/sampled_mesh.h"

namespace sherd {

/// A point of a face, or of a feature edge.
struct ResampledPoint {
  SampledMesh::Index face = 0;
  int edge = -1;       ///< of the face, from that corner to the next; -1: within the face
  double along = 0.0;  ///< of an edge, from its first end, 0..1
  glm::dvec3 at{0.0};
};

/// Returns random points: of the features, then of the faces, uniform by length and area but for
/// those that would be nearer to another one, or to a corner, than `distance`.
///   isCorner  [vertices] those that stay
///   seed      of the mesh
[[nodiscard]] std::vector<ResampledPoint> surfaceSamples(const SampledMesh& mesh,
                                                         const std::vector<bool>& isCorner,
                                                         double distance, std::uint64_t seed);

}  // namespace sherd
