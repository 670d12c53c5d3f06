// The closed mesh of a shell, for Surface::exact.
#include "voxelize/shell_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <unordered_map>
#include <vector>

#include "base/union_find.h"
#include "mesh/positions.h"

namespace sherd {
namespace {

// The sheets of a mesh: corners of triangles that are connected around a vertex are one vertex.
class Sheets {
 public:
  explicit Sheets(const TriangleMesh& mesh) : mesh_(mesh), first_(firstAtPosition(mesh.vertices)) {
    connect();
    move();
  }

  // Returns the number of vertices of one side.
  [[nodiscard]] std::size_t count() const { return at_.size(); }

  // Returns the vertex of a triangle's corner.
  [[nodiscard]] std::uint32_t vertexOf(std::size_t t, int k) const {
    return vertexOf_[3 * t + static_cast<std::size_t>(k)];
  }

  // Returns the way of a vertex to the front, for a thickness of 2.
  [[nodiscard]] const glm::dvec3& way(std::uint32_t v) const { return way_[v]; }
  [[nodiscard]] const glm::dvec3& at(std::uint32_t v) const { return at_[v]; }

  // Whether no triangle is connected to one over the edge after a corner.
  [[nodiscard]] bool isOpen(std::size_t t, int k) const {
    return isOpen_[3 * t + static_cast<std::size_t>(k)];
  }

 private:
  [[nodiscard]] std::uint32_t corner(std::size_t t, int k) const {
    return first_[mesh_.triangles[t][k % 3]];
  }

  void connect() {
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> uses;  // of undirected edges
    const std::size_t count = mesh_.triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      for (int k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax({corner(t, k), corner(t, k + 1)});
        uses[std::uint64_t{low} << 32 | high].push_back(
            static_cast<std::uint32_t>(3 * t + static_cast<std::size_t>(k)));
      }
    }
    isOpen_.assign(3 * count, true);
    UnionFind fans(3 * count);
    for (const auto& [edge, own] : uses) {
      if (own.size() != 2) continue;
      const auto next = [](std::uint32_t c) { return c % 3 == 2 ? c - 2 : c + 1; };
      const auto vertex = [&](std::uint32_t c) { return corner(c / 3, static_cast<int>(c % 3)); };
      if (vertex(own[0]) == vertex(own[1])) continue;  // in the same direction
      isOpen_[own[0]] = isOpen_[own[1]] = false;
      fans.unite(own[0], next(own[1]));
      fans.unite(next(own[0]), own[1]);
    }
    const std::vector<std::uint32_t> names = std::move(fans).all();
    vertexOf_.resize(3 * count);
    for (std::uint32_t c = 0; c < names.size(); ++c) {
      if (names[c] == c) {
        vertexOf_[c] = static_cast<std::uint32_t>(at_.size());
        at_.push_back(mesh_.vertices[mesh_.triangles[c / 3][static_cast<int>(c % 3)]]);
      } else {
        vertexOf_[c] = vertexOf_[names[c]];  // the name is the least corner
      }
    }
  }

  // Finds the ways of vertices, by normals weighted by the angles of corners.
  void move() {
    struct Corner {
      std::uint32_t vertex;
      glm::dvec3 normal;
      double angle;
    };
    std::vector<Corner> corners;
    way_.assign(at_.size(), glm::dvec3(0.0));
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3& p = mesh_.vertices[corner(t, k)];
        const glm::dvec3 a = mesh_.vertices[corner(t, k + 1)] - p,
                         b = mesh_.vertices[corner(t, k + 2)] - p;
        const glm::dvec3 across = glm::cross(a, b);
        const double length = glm::length(across);
        if (!(length > 0.0)) continue;
        corners.push_back({vertexOf(t, k), across / length, std::atan2(length, glm::dot(a, b))});
        way_[corners.back().vertex] += corners.back().normal * corners.back().angle;
      }
    }
    std::vector<double> angles(at_.size(), 0.0), along(at_.size(), 0.0);
    for (glm::dvec3& way : way_) {
      const double length = glm::length(way);
      if (length > 0.0) way /= length;
    }
    for (const Corner& c : corners) {
      angles[c.vertex] += c.angle;
      along[c.vertex] += c.angle * glm::dot(c.normal, way_[c.vertex]);
    }
    for (std::size_t v = 0; v < way_.size(); ++v) {
      const double mean = angles[v] > 0.0 ? along[v] / angles[v] : 1.0;
      way_[v] /= std::max(mean, 1.0 / kMostMiter);
    }
  }

  const TriangleMesh& mesh_;
  const std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> vertexOf_;  // [3 * triangles]
  std::vector<bool> isOpen_;             // [3 * triangles] the edge after a corner
  std::vector<glm::dvec3> at_, way_;     // [vertices]
};

}  // namespace

SolidMesh shellMesh(const SolidMesh& sheets, double thickness) {
  const TriangleMesh& mesh = sheets.mesh;
  const Sheets all(mesh);
  const auto back = static_cast<std::uint32_t>(all.count());  // of a vertex's number
  SolidMesh out;
  out.mesh.vertices.resize(2 * all.count());
  for (std::uint32_t v = 0; v < back; ++v) {
    const glm::dvec3 by = all.way(v) * (thickness / 2.0);
    out.mesh.vertices[v] = all.at(v) + by;
    out.mesh.vertices[v + back] = all.at(v) - by;
  }
  const auto add = [&](const glm::uvec3& triangle, std::uint32_t source) {
    out.mesh.triangles.push_back(triangle);
    out.source.push_back(source);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3 front{all.vertexOf(t, 0), all.vertexOf(t, 1), all.vertexOf(t, 2)};
    add(front, sheets.source[t]);
    add({front.x + back, front.z + back, front.y + back},
        sheets.back.empty() ? sheets.source[t] : sheets.back[t]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (!all.isOpen(t, k)) continue;
      const std::uint32_t from = all.vertexOf(t, k), to = all.vertexOf(t, (k + 1) % 3);
      add({to, from, from + back}, sheets.source[t]);
      add({to, from + back, to + back}, sheets.source[t]);
    }
  }
  return out;
}

}  // namespace sherd
