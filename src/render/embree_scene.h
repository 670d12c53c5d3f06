// A scene of triangles that Embree traces rays through.
#pragma once

#include <embree3/rtcore.h>

#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <type_traits>

namespace sherd {

struct EmbreeScene {
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, decltype(&rtcReleaseDevice)> device{
      nullptr, &rtcReleaseDevice};
  std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)> scene{
      nullptr, &rtcReleaseScene};
};

/// One geometry of a scene.
struct EmbreeMesh {
  std::span<const glm::vec3> vertices;  ///< [n + 1]: Embree reads 4 bytes past the last
  std::span<const glm::uvec3> triangles;
};

enum class EmbreeTree {
  exact,  ///< rays hit at least one of two triangles at their common edge; least memory
  quick,  ///< built in a quarter of the time, and rays may slip between triangles
};

/// Builds the tree; the meshes get the ids 0, 1, ... and must outlive the scene.
///   throws  Error(output) Embree failed
[[nodiscard]] EmbreeScene embreeScene(std::span<const EmbreeMesh> meshes, EmbreeTree tree);

/// Returns what a ray hits first; geomID is RTC_INVALID_GEOMETRY_ID if nothing.
[[nodiscard]] RTCHit firstHit(RTCScene scene, glm::vec3 origin, glm::vec3 direction);

}  // namespace sherd
