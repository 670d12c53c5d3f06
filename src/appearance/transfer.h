// Transfers the surface attributes of a mesh to surfaces near it.
#pragma once

#include <embree3/rtcore.h>
#include <sherd/mesh.h>

#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "mesh/attributes/charts.h"

namespace sherd {

/// The source mesh of an attribute transfer.  Const member functions are thread-safe.
///
/// A face gets its attributes from one chart of the source (see charts.h), that of the triangle
/// nearest to the face's centroid, so no face spans a seam: each corner gets the attributes of its
/// closest point on that chart.  Near a seam where a chart meets itself, only triangles connected
/// to the centroid's triangle within reach of the face are used.  A triangle whose normal opposes
/// the face's counts as two of the face's longest edges farther away, which selects the right side
/// of a thin wall.
class AttributeSource {
 public:
  ///   mesh            closed, of either orientation; normals always point outwards.  Its
  ///                   attributes are kept by reference
  ///   findsTriangles  needed by trianglesOf
  explicit AttributeSource(const TriangleMesh& mesh, bool findsTriangles = false);

  [[nodiscard]] bool findsTriangles() const { return findsTriangles_; }

  /// Returns the attributes of a mesh's faces.  Faces of the original surface get them from the
  /// source; all others get kInsideColor, texture coordinates 0 and the material index `inside`.
  ///
  /// With TriangleMesh::source a face gets them from the triangle that it is a part of: at that
  /// triangle's own corners the same, else interpolated.  Faces without one are fracture surfaces,
  /// or close holes: texture coordinates of both are projected then, along the coordinate axis that
  /// is nearest to the face's normal: one is one world unit.
  ///
  /// Only with TriangleMesh::source are normals transferred: flipped where the face is, and of unit
  /// length between the corners.  Those of faces without a source are 0, for writers to compute.
  ///   return  the same arrays as the source has
  ///   cost    triangles * log(the source's triangles)
  [[nodiscard]] SurfaceAttributes transferTo(const TriangleMesh& mesh, std::uint32_t inside) const;

  /// Returns the source's triangle of each face: with TriangleMesh::source the one that it is a
  /// part of, else the one of whose chart its attributes are.  Precondition: findsTriangles.
  ///   return  [triangles] TriangleMesh::kNoSource for those of fracture surfaces, and of an exact
  ///           surface where a hole was closed
  [[nodiscard]] std::vector<std::uint32_t> trianglesOf(const TriangleMesh& mesh) const;

 private:
  struct Query;
  struct Nearest;
  class Transfer;
  [[nodiscard]] Nearest nearestTo(const Query& face, std::uint32_t guess) const;
  [[nodiscard]] Query faceQuery(const TriangleMesh& mesh, const glm::uvec3& triangle) const;
  static bool visitTriangle(RTCPointQueryFunctionArguments* found);
  [[nodiscard]] Nearest nearest(const Query& query, const Nearest& start) const;
  [[nodiscard]] bool isNearSelfSeam(const glm::dvec3& point, double reach) const;
  [[nodiscard]] std::vector<std::uint32_t> patch(std::uint32_t triangle, const glm::dvec3& point,
                                                 double reach) const;
  [[nodiscard]] SurfaceAttributes fromSources(const TriangleMesh& mesh, std::uint32_t inside) const;
  void setFromSource(SurfaceAttributes& out, const TriangleMesh& mesh, std::size_t t) const;
  [[nodiscard]] SurfaceAttributes insideAttributes(std::size_t triangles,
                                                   std::uint32_t inside) const;
  void interpolate(SurfaceAttributes& out, std::size_t triangle, std::size_t corner,
                   std::uint32_t from, const glm::dvec3& weights) const;
  void setCorner(SurfaceAttributes& out, std::size_t triangle, std::size_t corner,
                 const Nearest& found) const;

  const SurfaceAttributes& attributes_;
  bool findsTriangles_;
  glm::dvec3 center_{0.0};
  double scale_ = 1.0;
  TriangleMesh mesh_;                ///< centered at 0, longest side 2
  std::vector<glm::dvec3> normals_;  ///< [triangles] unit, outwards
  Charts charts_;
  std::vector<glm::vec3> vertices_;  ///< [n + 1]: Embree reads 4 bytes past the last
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, decltype(&rtcReleaseDevice)> device_{
      nullptr, &rtcReleaseDevice};
  std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)> scene_{
      nullptr, &rtcReleaseScene};
  std::vector<glm::uvec3> seamTriangles_;  ///< those of charts_.selfSeam
  std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)> seams_{
      nullptr, &rtcReleaseScene};  ///< null if there are none
};

}  // namespace sherd
