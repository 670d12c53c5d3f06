// The parts of a cut surface, and the patches between seams.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "intersect/cut_mesh.h"
#include "remesh/face_edges.h"

namespace sherd {

/// A whole triangle or a part of one.
struct Part {
  glm::uvec3 corner{0};
  std::uint32_t source = 0;  ///< the whole triangle
};

/// Returns all triangles that are not crossed, and the parts of the others.
///   firstVertex  number of the triangles' vertex 0 among those of the parts
[[nodiscard]] std::vector<Part> partsOf(std::span<const glm::uvec3> triangles,
                                        const std::vector<std::uint8_t>& isCrossed,
                                        const std::vector<CutTriangle>& parts,
                                        std::uint32_t firstVertex);

/// The parts of a surface, and the patches that seams divide it into.
class Patches {
 public:
  ///   vertices  their number
  Patches(std::vector<Part> parts, std::size_t vertices, const std::vector<Seam>& seams);

  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  [[nodiscard]] const FaceEdges& edges() const { return edges_; }
  [[nodiscard]] bool isSeam(std::size_t edge) const { return isSeam_[edge]; }

  /// Returns the patch of a part: the index of its first part.
  [[nodiscard]] std::uint32_t patchOf(std::uint32_t part) const { return patchOf_[part]; }

  /// Calls visit(part, isLeft) for the parts on both sides of a seam.  Returns false if there are
  /// not two.
  template <class Visit>
  bool forEachBeside(const Seam& seam, const Visit& visit) const {
    const std::uint32_t edge = edges_.between(seam.from, seam.to);
    if (edge == FaceEdges::kNone) return false;
    bool isAnyLeft = false, isAnyRight = false;
    for (const FaceEdges::Use& use : edges_.uses(edge)) {
      const bool isLeft = use.isForward == (seam.from < seam.to);
      (isLeft ? isAnyLeft : isAnyRight) = true;
      visit(use.face, isLeft);
    }
    return isAnyLeft && isAnyRight;
  }

 private:
  std::vector<Part> parts_;
  FaceEdges edges_;
  std::vector<bool> isSeam_;
  std::vector<std::uint32_t> patchOf_;
};

}  // namespace sherd
