// What tests ask of meshes beside include/sherd/mesh.h.
#pragma once

#include <gtest/gtest.h>
#include <sherd/mesh.h>

#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <vector>

namespace sherd {

/// Vertices whose triangles are not one ring: round it each triangle's third edge leads to the
/// next.
inline std::size_t nonManifoldVertices(const TriangleMesh& mesh) {
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(mesh.vertices.size());
  std::vector<std::size_t> triangles(mesh.vertices.size(), 0);
  for (const glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      next[t[k]][t[(k + 1) % 3]] = t[(k + 2) % 3];
      ++triangles[t[k]];
    }
  }
  std::size_t bad = 0;
  for (std::size_t v = 0; v < next.size(); ++v) {
    std::size_t steps = 0;
    if (!next[v].empty()) {
      const std::uint32_t first = next[v].begin()->first;
      std::uint32_t at = first;
      do {
        const auto found = next[v].find(at);
        if (found == next[v].end()) break;
        at = found->second;
        ++steps;
      } while (at != first && steps <= triangles[v]);
    }
    bad += steps != triangles[v] || next[v].empty();
  }
  return bad;
}

/// Vertices that lie where another one lies.
inline std::size_t coincidentVertices(const TriangleMesh& mesh) {
  std::set<std::tuple<double, double, double>> places;
  for (const glm::dvec3& v : mesh.vertices) places.insert({v.x, v.y, v.z});
  return mesh.vertices.size() - places.size();
}

inline void expectClosedManifold(const TriangleMesh& mesh) {
  EXPECT_EQ(nonManifoldEdges(mesh), 0u);
  EXPECT_EQ(nonManifoldVertices(mesh), 0u);
}

/// Area by facing.
inline std::map<std::uint16_t, double> areas(const TriangleMesh& mesh) {
  const std::vector<std::uint16_t>& neighbor = mesh.neighbor;
  std::map<std::uint16_t, double> sums;
  for (std::size_t t = 0; t < neighbor.size(); ++t) {
    sums[neighbor[t]] += area({mesh.vertices, {mesh.triangles[t]}});
  }
  return sums;
}

/// Connected components of each facing's faces over edges.
inline std::map<std::uint16_t, std::size_t> regions(const TriangleMesh& mesh) {
  const std::vector<std::uint16_t>& neighbor = mesh.neighbor;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> owner;  // directed edge: triangle
  for (std::size_t t = 0; t < neighbor.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      owner[{mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]}] = t;
    }
  }
  std::map<std::uint16_t, std::size_t> count;
  std::vector<bool> seen(neighbor.size(), false);
  for (std::size_t first = 0; first < neighbor.size(); ++first) {
    if (seen[first]) continue;
    ++count[neighbor[first]];
    std::vector<std::size_t> stack{first};
    seen[first] = true;
    while (!stack.empty()) {
      const glm::uvec3 t = mesh.triangles[stack.back()];
      stack.pop_back();
      for (int k = 0; k < 3; ++k) {
        const auto across = owner.find({t[(k + 1) % 3], t[k]});
        if (across == owner.end() || seen[across->second]) continue;
        if (neighbor[across->second] != neighbor[first]) continue;
        seen[across->second] = true;
        stack.push_back(across->second);
      }
    }
  }
  return count;
}

}  // namespace sherd
