// Whether points lie inside a mesh.
#pragma once

#include <embree3/rtcore.h>
#include <sherd/mesh.h>

#include <memory>
#include <optional>
#include <type_traits>
#include <vector>

namespace sherd {

/// Asks a mesh for points inside it, by rays, in single precision.  Any thread may ask.
class InsideTest {
 public:
  ///   mesh  closed, oriented outwards, about as large as 1; copied
  explicit InsideTest(const TriangleMesh& mesh);

  /// Whether the mesh winds round the point.  Right where the point is farther from the surface
  /// than single precision can tell, some 1e-6 of the mesh.
  [[nodiscard]] bool contains(const glm::dvec3& point) const;

  /// What three rays say, if they agree.  Wrong answers that agree are for points on the surface,
  /// as single precision has it.
  [[nodiscard]] std::optional<bool> unanimous(const glm::dvec3& point) const;

  /// The mesh, in single precision, as geometry 0 with its triangles in their order.
  [[nodiscard]] RTCScene scene() const { return scene_.get(); }

 private:
  [[nodiscard]] bool windsAlong(const glm::vec3& origin, const glm::vec3& direction) const;

  std::vector<glm::vec3> vertices_;  ///< [n + 1]: Embree reads 4 bytes past the last
  std::vector<glm::uvec3> triangles_;
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, decltype(&rtcReleaseDevice)> device_{
      nullptr, &rtcReleaseDevice};
  std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)> scene_{
      nullptr, &rtcReleaseScene};
};

}  // namespace sherd
