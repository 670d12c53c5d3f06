// How far points are from a mesh, negative inside.
#include <sherd/points.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "mesh/mesh_distance.h"

namespace sherd {

std::vector<double> signedDistances(const TriangleMesh& mesh, std::span<const glm::dvec3> points,
                                    const Progress* progress) {
  const MeshDistance body(mesh);
  std::vector<double> distances(points.size());
  const auto measure = [&](std::size_t i) {
    const double distance = body.distance(points[i]);
    distances[i] = body.contains(points[i], distance) ? -distance : distance;
  };
  // In rounds, so that the caller's thread can report and be stopped between them.
  constexpr std::size_t kRound = 65536;
  for (std::size_t first = 0; first < points.size(); first += kRound) {
    step(progress, "distances", static_cast<double>(first) / static_cast<double>(points.size()));
    tbb::parallel_for(first, std::min(first + kRound, points.size()), measure);
  }
  return distances;
}

}  // namespace sherd
