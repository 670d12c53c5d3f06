// The exploded fragments as an Embree scene.
#pragma once

#include <embree3/rtcore.h>
#include <sherd/render.h>

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <type_traits>
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
};

struct Scene {
  std::vector<glm::dvec3> shifts;        ///< [fragments] displacement of each, world units
  double size = 1.0;                     ///< world units per scene unit
  std::vector<SceneFragment> fragments;  ///< indexed by Embree's geometry id
  std::vector<glm::vec3> boxCorners;     ///< [8] of the whole
  float groundY = 0.0f;                  ///< height of the lowest vertex, scene units

  std::unique_ptr<std::remove_pointer_t<RTCDevice>, decltype(&rtcReleaseDevice)> device{
      nullptr, &rtcReleaseDevice};
  std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)> embree{
      nullptr, &rtcReleaseScene};
};

/// Converts a direction of the scene, y up, to the mesh's own axes.
///   up  RenderOptions::up
[[nodiscard]] glm::vec3 worldDirection(const glm::vec3& direction, char up);

/// Explodes, centers and scales the fragments, computes smooth normals, and builds Embree's tree.
///   fragments  must outlive the scene
///   throws     Error(output) Embree failed
[[nodiscard]] Scene makeScene(std::span<const Fragment> fragments, const RenderOptions& options);

}  // namespace sherd
