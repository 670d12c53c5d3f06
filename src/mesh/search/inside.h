// Point-in-mesh test by ray casting.
#pragma once

#include <embree3/rtcore.h>
#include <sherd/mesh.h>

#include <memory>
#include <optional>
#include <type_traits>
#include <vector>

namespace sherd {

/// Tests whether points are inside a mesh, by rays in single precision.  Thread-safe.
class InsideTest {
 public:
  ///   mesh  closed, oriented outwards, about as large as 1; copied
  explicit InsideTest(const TriangleMesh& mesh);

  /// Whether the point is inside, by the majority of three rays.  Correct for points farther from
  /// the surface than single precision resolves, some 1e-6 of the mesh's size.
  [[nodiscard]] bool contains(const glm::dvec3& point) const;

  /// Returns the result of three rays if they agree.  It can be wrong only for points that are on
  /// the surface in single precision.
  [[nodiscard]] std::optional<bool> unanimous(const glm::dvec3& point) const;

  /// The mesh in single precision as geometry 0, with its triangles in the same order.
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
