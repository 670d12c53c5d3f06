// Distances within contacts to their boundaries.
#include "surface/boundary_distance.h"

#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

namespace sherd {

std::vector<std::uint16_t> contactsOf(const TriangleMesh& mesh) {
  std::vector<std::uint16_t> contact(mesh.vertices.size(), kNoContact);
  std::vector<bool> isMet(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      if (isMet[v] && contact[v] != mesh.neighborOf(t)) contact[v] = kContactBoundary;
      if (!isMet[v]) contact[v] = mesh.neighborOf(t);
      isMet[v] = true;
    }
  }
  return contact;
}

std::vector<double> boundaryDistances(const TriangleMesh& mesh,
                                      const std::vector<std::uint16_t>& contact, double voxelSize,
                                      double most) {
  // The ends of the edges from each vertex: those of first[v] to first[v + 1].  An edge is there
  // once for each of its faces.
  std::vector<std::uint32_t> first(contact.size() + 1, 0);
  const auto forEachEdge = [&](const auto& visit) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.neighborOf(t) == kNoContact) continue;
      const glm::uvec3& corner = mesh.triangles[t];
      for (int k = 0; k < 3; ++k) {
        visit(corner[k], corner[(k + 1) % 3]);
        visit(corner[(k + 1) % 3], corner[k]);
      }
    }
  };
  forEachEdge([&](std::uint32_t from, std::uint32_t) { ++first[from + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint32_t> ends(first.back()), next(first.begin(), first.end() - 1);
  forEachEdge([&](std::uint32_t from, std::uint32_t to) { ends[next[from]++] = to; });
  using Reached = std::pair<double, std::uint32_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
  std::vector<double> distance(contact.size(), std::numeric_limits<double>::infinity());
  const auto reach = [&](std::uint32_t v, double from) {
    if (!(from <= most && from < distance[v])) return;
    distance[v] = from;
    queue.emplace(from, v);
  };
  for (std::uint32_t v = 0; v < contact.size(); ++v) {
    if (contact[v] == kContactBoundary) reach(v, 0.0);
  }
  while (!queue.empty()) {
    const auto [from, v] = queue.top();
    queue.pop();
    if (from > distance[v]) continue;
    for (std::uint32_t e = first[v]; e < first[v + 1]; ++e) {
      const glm::dvec3 way = mesh.vertices[ends[e]] - mesh.vertices[v];
      reach(ends[e], from + glm::length(way) / voxelSize);
    }
  }
  return distance;
}

}  // namespace sherd
