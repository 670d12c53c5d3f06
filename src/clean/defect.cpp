// Short edges and thin faces.
#include "clean/defect.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

namespace sherd {
namespace {

std::vector<Defect> sortedDefects(std::vector<Defect> defects) {
  std::sort(defects.begin(), defects.end());
  defects.erase(std::unique(defects.begin(), defects.end()), defects.end());
  return defects;
}

}  // namespace

std::array<Defect, 3> edgesOf(const glm::uvec3& corner, const std::vector<glm::dvec3>& positions) {
  std::array<Defect, 3> edges;
  for (int k = 0; k < 3; ++k) {
    const auto [a, b] = std::minmax(corner[k], corner[(k + 1) % 3]);
    edges[static_cast<std::size_t>(k)] = {glm::distance(positions[a], positions[b]), a, b};
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

Defect thinnest(const glm::uvec3& corner, const std::vector<glm::dvec3>& positions) {
  int longest = 0;
  double length = -1.0;
  for (int k = 0; k < 3; ++k) {
    const double own = glm::distance(positions[corner[k]], positions[corner[(k + 1) % 3]]);
    if (own <= length) continue;
    length = own;
    longest = k;
  }
  const auto [a, b] = std::minmax(corner[longest], corner[(longest + 1) % 3]);
  const glm::dvec3& origin = positions[corner.x];
  const double twice =
      glm::length(glm::cross(positions[corner.y] - origin, positions[corner.z] - origin));
  return {length > 0.0 ? twice / length : 0.0, a, b, corner[(longest + 2) % 3]};
}

std::vector<Defect> shortEdges(const Stars& stars, const std::vector<std::uint32_t>& faces,
                               const std::vector<glm::dvec3>& positions,
                               const std::vector<bool>& isFixed, double below) {
  std::vector<Defect> found;
  for (const std::uint32_t f : faces) {
    if (!stars.isThere(f) || !stars.face(f).isPrimary()) continue;
    for (const Defect& edge : edgesOf(stars.face(f).corner, positions)) {
      if (edge.size < below && !(isFixed[edge.a] && isFixed[edge.b])) found.push_back(edge);
    }
  }
  return sortedDefects(std::move(found));
}

std::vector<Defect> thinFaces(const Stars& stars, const std::vector<std::uint32_t>& faces,
                              const std::vector<glm::dvec3>& positions, double below) {
  std::vector<Defect> found;
  for (const std::uint32_t f : faces) {
    if (!stars.isThere(f) || !stars.face(f).isPrimary()) continue;
    const Defect defect = thinnest(stars.face(f).corner, positions);
    if (defect.size < below) found.push_back(defect);
  }
  return sortedDefects(std::move(found));
}

}  // namespace sherd
