// Carries the look of a mesh over to surfaces that lie near it.
#pragma once

#include <embree3/rtcore.h>
#include <sherd/appearance.h>
#include <sherd/mesh.h>

#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "appearance/charts.h"

namespace sherd {

/// A mesh whose look is asked for.  Any thread may ask.
///
/// A face takes its look from one chart of the mesh (see charts.h), that of the triangle nearest to
/// its centroid, so no face spans a seam: each of its corners takes the look of the point of that
/// chart which is nearest to it.  Near a seam where a chart meets itself only that part of it
/// counts which hangs together, near the face, with the centroid's triangle.  A triangle whose
/// normal disagrees with the face's counts as two of the face's longest edges farther away, so that
/// of a thin wall's two sides the right one is taken.
class LookSource {
 public:
  ///   mesh  closed; where it is oriented inwards, so are its normals taken.  Both are kept by
  ///         reference.
  LookSource(const TriangleMesh& mesh, const SurfaceLook& look);

  /// The look of faces.  Those of the original surface take it from the mesh; all others have
  /// kInsideColour, texture coordinates 0 and the material number `inside`.
  ///   facing  [triangles] 0 original surface
  ///   return  has the arrays that the mesh's look has
  ///   cost    triangles * log(the mesh's triangles)
  [[nodiscard]] SurfaceLook on(const TriangleMesh& mesh, std::span<const std::uint16_t> facing,
                               std::uint32_t inside) const;

 private:
  struct Query;
  struct Nearest;
  static bool lookAt(RTCPointQueryFunctionArguments* found);
  [[nodiscard]] Nearest nearest(const Query& query, const Nearest& start) const;
  [[nodiscard]] bool isNearOwnSeam(const glm::dvec3& point, double reach) const;
  [[nodiscard]] std::vector<std::uint32_t> patch(std::uint32_t triangle, const glm::dvec3& point,
                                                 double reach) const;
  void setCorner(SurfaceLook& out, std::size_t triangle, std::size_t corner,
                 const Nearest& found) const;

  const SurfaceLook& look_;
  glm::dvec3 middle_{0.0};
  double scale_ = 1.0;
  TriangleMesh mesh_;                ///< about 0, its longest side 2
  std::vector<glm::dvec3> normals_;  ///< [triangles] unit, outwards
  Charts charts_;
  std::vector<glm::vec3> vertices_;  ///< [n + 1]: Embree reads 4 bytes past the last
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, decltype(&rtcReleaseDevice)> device_{
      nullptr, &rtcReleaseDevice};
  std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)> scene_{
      nullptr, &rtcReleaseScene};
  std::vector<glm::uvec3> seamTriangles_;  ///< those of charts_.ownSeam
  std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)> seams_{
      nullptr, &rtcReleaseScene};  ///< null where there are none
};

}  // namespace sherd
