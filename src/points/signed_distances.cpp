// Signed distances of points to a mesh, negative inside.
#include <sherd/points.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "points/distance_sequence.h"

namespace sherd {

std::vector<double> signedDistances(const MeshDistance& surface, std::span<const glm::dvec3> points,
                                    std::size_t first, std::size_t all, const Progress* progress) {
  std::vector<double> distances(points.size());
  const auto measure = [&](std::size_t i) {
    const double distance = surface.distance(points[i]);
    distances[i] = surface.contains(points[i], distance) ? -distance : distance;
  };
  // In batches, so that the calling thread can report progress and be cancelled in between.
  constexpr std::size_t kBatch = 65536;
  for (std::size_t begin = 0; begin < points.size(); begin += kBatch) {
    reportProgress(progress, "distances",
                   static_cast<double>(first + begin) / static_cast<double>(all));
    tbb::parallel_for(begin, std::min(begin + kBatch, points.size()), measure);
  }
  return distances;
}

std::vector<double> signedDistances(const TriangleMesh& mesh, std::span<const glm::dvec3> points,
                                    const Progress* progress) {
  return signedDistances(MeshDistance(mesh), points, 0, points.size(), progress);
}

}  // namespace sherd
