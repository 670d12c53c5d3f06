// Triangulates a face with vertices on its sides, by dynamic programming over its diagonals.
#include "remesh/face_ring.h"

#include <limits>

namespace sherd {

std::vector<std::array<std::size_t, 3>> triangulated(
    const FaceRing& ring, std::span<const glm::dvec3> vertices,
    const std::function<double(const glm::dvec3&, const glm::dvec3&)>& cost) {
  const std::size_t n = ring.size();
  const auto at = [&](std::size_t i) { return vertices[ring[i % n].vertex]; };
  std::size_t lowest = 0;
  for (std::size_t i = 1; i < n; ++i) {
    if (isBefore(at(i), at(lowest))) lowest = i;
  }
  const bool isForward = isBefore(at(lowest + 1), at(lowest + n - 1));
  const auto index = [&](std::size_t i) { return (lowest + (isForward ? i : n - i)) % n; };
  // The least cost of the diagonals between points i and j, and the corner beyond the last one.
  std::vector<double> least(n * n, 0.0);
  std::vector<std::size_t> corner(n * n, 0);
  for (std::size_t size = 2; size < n; ++size) {
    for (std::size_t i = 0; i + size < n; ++i) {
      const std::size_t j = i + size;
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t k = i + 1; k < j; ++k) {
        if (ring[index(i)].sides & ring[index(k)].sides & ring[index(j)].sides) continue;
        const double all = least[i * n + k] + least[k * n + j];
        if (all < best) best = all, corner[i * n + j] = k;
      }
      least[i * n + j] = best;
      const bool isDiagonal = size + 1 < n && !(ring[index(i)].sides & ring[index(j)].sides);
      if (!isDiagonal) continue;
      const glm::dvec3 a = at(index(i)), b = at(index(j));
      least[i * n + j] += isBefore(a, b) ? cost(a, b) : cost(b, a);
    }
  }
  std::vector<std::array<std::size_t, 3>> out;
  std::vector<std::array<std::size_t, 2>> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const std::size_t k = corner[i * n + j];
    out.push_back({index(i), index(isForward ? k : j), index(isForward ? j : k)});
    open.push_back({i, k});
    open.push_back({k, j});
  }
  return out;
}

}  // namespace sherd
