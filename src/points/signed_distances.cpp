// Signed distances of points to a mesh, negative inside.
#include <sherd/points.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "mesh/mesh_distance.h"

namespace sherd {

std::vector<double> signedDistances(const TriangleMesh& mesh, std::span<const glm::dvec3> points,
                                    const Progress* progress) {
  const MeshDistance surface(mesh);
  std::vector<double> distances(points.size());
  const auto measure = [&](std::size_t i) {
    const double distance = surface.distance(points[i]);
    distances[i] = surface.contains(points[i], distance) ? -distance : distance;
  };
  // In batches, so that the calling thread can report progress and be cancelled in between.
  constexpr std::size_t kBatch = 65536;
  for (std::size_t first = 0; first < points.size(); first += kBatch) {
    reportProgress(progress, "distances",
                   static_cast<double>(first) / static_cast<double>(points.size()));
    tbb::parallel_for(first, std::min(first + kBatch, points.size()), measure);
  }
  return distances;
}

}  // namespace sherd
