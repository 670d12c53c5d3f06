// One mesh of all labels, which contains the mesh of each fragment.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "interface/interface_surface.h"
#include "remesh/complex.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// All labels meshed together: a dual mesh over the cells between voxel centers, with two triangles
/// for each pair of face-adjacent voxels of different labels.  Two fragments therefore share one
/// set of faces, identical to the bit from both sides, and both labels of a face are known.
///
/// A cell has a vertex per sheet, and sheets may share a position (see cell.h).  It is the mean of
/// the crossings of the cell's edges by the solid's surface or the cut, as in surface nets; on
/// creases of the input it is where Creases has it.  Where
/// surfaces of several pairs of labels meet it is the intersection of their planes, so that contact
/// boundaries are sharp.
///   source  Gibson, Constrained Elastic Surface Nets, 1998; Ju et al., Dual Contouring of Hermite
///           Data, 2002; Wenger, Isosurfaces, 2013 (cells that share an ambiguous face)
class InterfaceMeshes {
 public:
  /// Numbers the vertices of each label.  All arguments must outlive the object.
  ///   surface        with all vertices
  ///   neighborhoods  of the solid's leaves
  ///   intact         of which the surface reuses leaves, or null
  InterfaceMeshes(const InterfaceSurface& surface, std::span<const LeafNeighbors> neighborhoods,
                  const IntactSurface* intact);

  /// Returns the mesh of a label, 1..fragmentCount.  It is assembled on each call, because storing
  /// all meshes would double the memory.  Thread-safe.
  [[nodiscard]] LabeledMesh meshOf(std::uint16_t label) const;

 private:
  // Consecutive vertices of one label.
  struct Run {
    std::uint32_t first = 0, count = 0;
  };

  void addReused(std::uint32_t leaf, LabeledMesh& out) const;

  const InterfaceSurface& surface_;
  std::span<const LeafNeighbors> neighborhoods_;
  const IntactSurface* intact_;
  std::vector<std::uint32_t> number_;        // [vertices] in its label's mesh
  std::vector<std::vector<Run>> runsOf_;     // [labels + 1] ascending
  std::vector<std::uint32_t> vertexCounts_;  // [labels + 1]
};

}  // namespace sherd
