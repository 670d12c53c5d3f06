// The mesh of all labels, leaf by leaf.
#pragma once

#include <sherd/labels.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <cstdint>
#include <span>
#include <vector>

#include "cut/cut.h"
#include "interface/cells/contact_boundaries.h"
#include "interface/cells/leaf_cells.h"
#include "interface/intact.h"
#include "interface/non_manifold_vertices.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// Of which leaves an InterfaceSurface has vertices.
enum class SurfaceVertices {
  all,
  changed,  ///< of those whose triangles differ from the intact solid's, and those below them
};

/// All labels meshed together (see InterfaceMeshes): vertices, quads and gaps.  A leaf with only
/// one label has the same surface as in the intact solid.  If that is given, the cells and
/// triangles of such leaves are reused; in the others, cells with one label and the quads between
/// them.  Only the rest is made.
class InterfaceSurface {
 public:
  ///   neighborhoods  of the solid's leaves
  ///   creases        of this solid
  ///   intact         of this solid, or null
  ///   throws         Error(cancelled)
  InterfaceSurface(const Solid& solid, const Labels& labels, const Cut& cut,
                   std::span<const LeafNeighbors> neighborhoods, const Creases& creases,
                   const IntactSurface* intact, SurfaceVertices extent, const Progress* progress);

  InterfaceSurface(const InterfaceSurface&) = delete;
  InterfaceSurface& operator=(const InterfaceSurface&) = delete;

  /// Returns whether the leaf's triangles are those of the intact solid.  Next to a crack they are
  /// not, because they use vertices of changed leaves.
  [[nodiscard]] bool reusesTriangles(std::size_t leaf) const { return reusesTriangles_[leaf] != 0; }

  /// Returns bits of the octants (see octantOf) of a leaf that does not reuse triangles, in which
  /// all quads are the intact solid's, and of one label.
  [[nodiscard]] std::uint8_t intactOctants(std::size_t leaf) const { return intactOctants_[leaf]; }

  /// Returns the index of the leaf's first vertex, kNone if SurfaceVertices left them out.
  static constexpr std::uint32_t kNone = 0xffffffffu;
  [[nodiscard]] std::uint32_t firstVertex(std::size_t leaf) const { return firstVertex_[leaf]; }

  [[nodiscard]] std::size_t leaves() const { return quads_.size(); }

  /// Returns the number of labels with meshes.
  [[nodiscard]] std::size_t labels() const { return leavesOf_.size() - 1; }

  /// World units.
  [[nodiscard]] const InterfaceVertices& vertices() const { return vertices_; }

  /// Returns [vertices] the label of each; 0 if no face has it.
  [[nodiscard]] std::span<const std::uint16_t> vertexLabels() const { return vertexLabels_; }

  /// Returns the leaves with faces of a label, ascending.
  [[nodiscard]] std::span<const std::uint32_t> leavesOf(std::uint16_t label) const {
    return leavesOf_[label];
  }

  /// Returns the quads of a leaf that does not reuse triangles, settled, by label.
  [[nodiscard]] std::span<const InterfaceQuad> quadsOf(std::size_t leaf) const {
    return quads_[leaf];
  }

  /// Returns those of one label.
  [[nodiscard]] std::span<const InterfaceQuad> quadsOf(std::size_t leaf, std::uint16_t label) const;

  /// Returns a label's triangles in gaps.
  [[nodiscard]] std::span<const InterfaceTriangle* const> gapsOf(std::uint16_t label) const {
    return gapsOf_[label];
  }

 private:
  class Builder;

  std::vector<std::uint8_t> reusesTriangles_;  // [leaf]
  std::vector<std::uint8_t> intactOctants_;    // [leaf]
  std::vector<std::uint32_t> firstVertex_;     // [leaf] or kNone
  InterfaceVertices vertices_;
  std::vector<std::uint16_t> vertexLabels_;
  std::vector<std::vector<InterfaceQuad>> quads_;  // [leaf] sorted by label
  std::vector<InterfaceTriangle> gaps_;
  std::vector<std::vector<std::uint32_t>> leavesOf_;           // [labels + 1]
  std::vector<std::vector<const InterfaceTriangle*>> gapsOf_;  // [labels + 1]
};

}  // namespace sherd
