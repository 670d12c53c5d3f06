// Splitting of non-manifold vertices, where two sheets of one label's surface touch.
#pragma once

#include <sherd/labels.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "interface/cells/contact_boundaries.h"

namespace sherd {

/// The outside and eroded voxels have no mesh.
[[nodiscard]] inline bool hasMesh(std::uint16_t label) {
  return label != 0 && label != Labels::kEroded;
}

/// The vertices of the mesh of all labels.  Each belongs to one label; vertices of several labels
/// may share a position.
struct InterfaceVertices {
  std::vector<glm::dvec3> at;             ///< index space
  std::vector<std::uint32_t> positionId;  ///< equal for vertices that share a position
  std::uint32_t positionCount = 0;
};

/// One side of a triangle that fills a gap between two labels.
struct InterfaceTriangle {
  std::uint16_t label = 0;
  std::uint16_t other = 0;
  std::array<std::uint32_t, 3> vertex{};
};

/// Splits non-manifold vertices.  Where a label has two vertices at one position, two sheets of its
/// surface touch, and a reader that merges equal positions gets a non-manifold mesh.  Moves one of
/// the sheets by a tenth of a voxel into the label, together with the neighbors' vertices there.
/// Triangles fill the gaps between neighbors, so all meshes stay closed, and both sides of each
/// face stay equal to the bit.
///
/// A sheet is not moved if that would make two sheets of a neighbor touch.
///   nonManifold  positionIds at which a label has several vertices
///   quads        [leaves][..] the two sides of a quad are adjacent
///   return       the triangles in the gaps, of every label but Labels::kEroded
[[nodiscard]] std::vector<InterfaceTriangle> splitNonManifoldVertices(
    std::span<const std::uint32_t> nonManifold, std::span<std::vector<InterfaceQuad>> quads,
    InterfaceVertices& vertices);

}  // namespace sherd
