// The components of a mesh as meshes.
#pragma once

#include <sherd/mesh.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// The components of a mesh as meshes of their own.
class ComponentMeshes {
 public:
  ///   vertices  of the mesh, possibly in another space; kept by reference
  ComponentMeshes(std::span<const glm::dvec3> vertices, const TriangleMesh& mesh,
                  const MeshComponents& components)
      : vertices_(vertices), triangles_(components.count) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      triangles_[components.ofTriangle[t]].push_back(mesh.triangles[t]);
    }
  }

  [[nodiscard]] std::size_t count() const { return triangles_.size(); }

  /// Returns the mesh of some components.
  [[nodiscard]] TriangleMesh joined(std::span<const std::uint32_t> some) const {
    TriangleMesh out;
    std::vector<std::uint32_t> used;
    for (const std::uint32_t c : some) {
      for (const glm::uvec3& t : triangles_[c]) used.insert(used.end(), {t.x, t.y, t.z});
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const auto numberOf = [&](std::uint32_t v) {
      return static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) -
                                        used.begin());
    };
    for (const std::uint32_t v : used) out.vertices.push_back(vertices_[v]);
    for (const std::uint32_t c : some) {
      for (const glm::uvec3& t : triangles_[c]) {
        out.triangles.emplace_back(numberOf(t.x), numberOf(t.y), numberOf(t.z));
      }
    }
    return out;
  }

  /// Returns a vertex of a component.
  [[nodiscard]] glm::dvec3 point(std::uint32_t component) const {
    return vertices_[triangles_[component].front().x];
  }

 private:
  std::span<const glm::dvec3> vertices_;
  std::vector<std::vector<glm::uvec3>> triangles_;
};

}  // namespace sherd
