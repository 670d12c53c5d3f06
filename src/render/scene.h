// The exploded fragments, centered and scaled.
#pragma once

#include <sherd/render.h>

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// One fragment in scene space: y up, origin at the center of the exploded whole, whose box has a
/// half diagonal of 1.
struct SceneFragment {
  std::vector<glm::vec3> vertices;        ///< [n + 1]: Embree reads 4 bytes past the last
  std::span<const glm::uvec3> triangles;  ///< [m] the fragment's
  std::vector<glm::vec3> normals;         ///< unit; one for each smooth side of a vertex
  std::vector<glm::uvec3> normalOf;       ///< [m] indices of the corners' normals
  std::vector<std::uint8_t> inner;        ///< [m] 1 for a fracture face

  /// Returns the smooth normal at barycentric coordinates (u, v).
  [[nodiscard]] glm::vec3 normalAt(unsigned triangle, float u, float v) const {
    const glm::uvec3& n = normalOf[triangle];
    return glm::normalize((1.0f - u - v) * normals[n.x] + u * normals[n.y] + v * normals[n.z]);
  }

  /// Returns the unit normal of a triangle's side that faces a point.
  [[nodiscard]] glm::vec3 faceTowards(unsigned triangle, glm::vec3 point) const {
    const glm::uvec3& t = triangles[triangle];
    const glm::vec3 a = vertices[t.x];
    const glm::vec3 area = glm::cross(vertices[t.y] - a, vertices[t.z] - a);
    const float length = glm::length(area);
    const glm::vec3 face = length > 0.0f ? area / length : glm::vec3(0.0f, 1.0f, 0.0f);
    return glm::dot(face, point - a) < 0.0f ? -face : face;
  }
};

struct Scene {
  std::vector<glm::dvec3> shifts;  ///< [fragments] displacement of each, world units
  double size = 1.0;               ///< world units per scene unit
  std::vector<SceneFragment> fragments;
  std::vector<glm::vec3> boxCorners;  ///< [8] of the whole
  float groundY = 0.0f;               ///< height of the lowest vertex, scene units
};

/// Converts a direction of the scene, y up, to the mesh's own axes.
///   up  RenderOptions::up
[[nodiscard]] glm::vec3 worldDirection(const glm::vec3& direction, char up);

/// Explodes, centers and scales the fragments, and computes smooth normals.
///   fragments  must outlive the scene
[[nodiscard]] Scene makeScene(std::span<const Fragment> fragments, const RenderOptions& options);

}  // namespace sherd
