// Compares the vertices of different meshes.
#include "evaluate/cracks/coincident_vertices.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>
#include <vector>

#include "base/cancel_flag.h"

namespace sherd {
namespace {

/// A cell of a grid in which points are compared.
using Cell = std::array<double, 3>;

}  // namespace

double coincidentShare(std::span<const DividedMesh> meshes, double distance,
                       const Progress* progress) {
  struct Vertex {
    Cell cell;
    std::size_t mesh;
    glm::dvec3 at;
  };
  std::vector<Vertex> vertices;
  const auto cellOf = [&](const glm::dvec3& p) {
    return Cell{std::floor(p.x / distance), std::floor(p.y / distance), std::floor(p.z / distance)};
  };
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    std::vector<char> isUsed(meshes[i].mesh->vertices.size());
    for (const glm::uvec3& t : meshes[i].mesh->triangles)
      isUsed[t.x] = isUsed[t.y] = isUsed[t.z] = 1;
    for (std::size_t v = 0; v < isUsed.size(); ++v) {
      const glm::dvec3& p = meshes[i].mesh->vertices[v];
      if (isUsed[v]) vertices.push_back({cellOf(p), i, p});
    }
  }
  const auto before = [](const Vertex& a, const Vertex& b) {
    return std::tie(a.cell, a.mesh) < std::tie(b.cell, b.mesh);
  };
  std::sort(vertices.begin(), vertices.end(), before);
  std::vector<char> isCoincident(vertices.size());
  tbb::parallel_for(std::size_t{0}, vertices.size(), [&](std::size_t i) {
    if (i % 4096 == 0) throwIfCancelled(progress);
    const Vertex& own = vertices[i];
    for (int k = 0; k < 27 && !isCoincident[i]; ++k) {
      const Cell cell{own.cell[0] + k % 3 - 1, own.cell[1] + k / 3 % 3 - 1,
                      own.cell[2] + k / 9 - 1};
      auto other = std::lower_bound(vertices.begin(), vertices.end(), Vertex{cell, 0, {}}, before);
      while (other != vertices.end() && other->cell == cell && !isCoincident[i]) {
        if (other->mesh == own.mesh) {  // of which a cell may have very many
          other = std::lower_bound(other, vertices.end(), Vertex{cell, own.mesh + 1, {}}, before);
          continue;
        }
        isCoincident[i] = glm::distance(other->at, own.at) <= distance;
        ++other;
      }
    }
  });
  const auto count = std::count(isCoincident.begin(), isCoincident.end(), 1);
  return vertices.empty() ? 0.0 : static_cast<double>(count) / static_cast<double>(vertices.size());
}

}  // namespace sherd
