// The exploded fragments as Embree sees them.
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

/// One fragment in scene space: y up, centred on the exploded whole, whose box has a half diagonal
/// of 1.
struct Piece {
  std::vector<glm::vec3> vertices;        ///< [n + 1]: Embree reads 4 bytes past the last
  std::span<const glm::uvec3> triangles;  ///< [m] the fragment's
  std::vector<glm::vec3> normals;         ///< unit normals; a vertex has one for each smooth side
  std::vector<glm::uvec3> normalOf;       ///< [m] which of them the corners have
  std::vector<std::uint8_t> inner;        ///< [m] 1 for a fracture face

  /// The smooth normal at a hit's barycentric coordinates.
  [[nodiscard]] glm::vec3 normalAt(unsigned triangle, float u, float v) const {
    const glm::uvec3& n = normalOf[triangle];
    return glm::normalize((1.0f - u - v) * normals[n.x] + u * normals[n.y] + v * normals[n.z]);
  }
};

struct Scene {
  std::vector<glm::dvec3> shifts;     ///< [pieces] by how much each was moved; world
  double size = 1.0;                  ///< world units in a unit of the scene
  std::vector<Piece> pieces;          ///< Embree's geometry id is the index
  std::vector<glm::vec3> boxCorners;  ///< [8] of the whole
  float groundY = 0.0f;               ///< the lowest vertex lies here

  std::unique_ptr<std::remove_pointer_t<RTCDevice>, decltype(&rtcReleaseDevice)> device{
      nullptr, &rtcReleaseDevice};
  std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)> embree{
      nullptr, &rtcReleaseScene};
};

/// A direction of the scene, y up, in the mesh's own axes.
///   up  RenderOptions::up
[[nodiscard]] glm::vec3 worldDirection(const glm::vec3& direction, char up);

/// Explode, centre and scale the fragments, give them smooth normals, and build the tree of boxes.
///   fragments  have to outlive the scene
///   throws  Error(output) when Embree fails
[[nodiscard]] Scene makeScene(std::span<const Fragment> fragments, const RenderOptions& options);

}  // namespace sherd
