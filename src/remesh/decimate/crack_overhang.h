// Where cracks end, beyond the mesh that they cut.
#pragma once

#include <sherd/mesh.h>

#include <glm/vec3.hpp>

#include "mesh/search/triangle_tree.h"

namespace sherd {

/// Cracks overhang the mesh, and end beyond it.  Their ends may be anywhere as long as they stay
/// there.
class CrackOverhang {
 public:
  explicit CrackOverhang(const TriangleMesh& mesh) : tree_(mesh) {}

  /// Returns whether an edge at which a crack ends, from `from` to `end`, may become one from `to`
  /// to `end`: if the triangle between them does not meet the mesh, and the edge is not nearer to
  /// it than kLeastOverhang.
  [[nodiscard]] bool mayMove(const glm::dvec3& from, const glm::dvec3& to,
                             const glm::dvec3& end) const;

  /// In units of the mesh; much more than vertices are displaced by.
  static constexpr double kLeastOverhang = 0.1;

 private:
  [[nodiscard]] bool meets(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) const;
  [[nodiscard]] bool isNear(const glm::dvec3& from, const glm::dvec3& to) const;

  const TriangleTree tree_;
};

}  // namespace sherd
