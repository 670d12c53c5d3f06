// One mesh of all labels, which contains the mesh of each fragment.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <memory>
#include <span>

#include "surface/complex.h"
#include "surface/cut.h"
#include "voxelize/leaf_blocks.h"

namespace sherd {

class Creases;
struct IntactSurface;

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
  /// Meshes labels 1..fragmentCount.  All arguments must outlive the object.
  ///   neighborhoods  of the solid's leaves
  ///   creases        of this solid
  ///   intact         of this solid, or null: unchanged leaves are reused, with equal meshes
  ///   throws         Error(cancelled)
  InterfaceMeshes(const Solid& solid, const Labels& labels, const Cut& cut,
                  std::span<const LeafNeighbors> neighborhoods, const Creases& creases,
                  const IntactSurface* intact = nullptr, const Progress* progress = nullptr);
  ~InterfaceMeshes();
  InterfaceMeshes(const InterfaceMeshes&) = delete;
  InterfaceMeshes& operator=(const InterfaceMeshes&) = delete;

  /// Returns the mesh of a label.  It is assembled on each call, because storing all meshes would
  /// double the memory.  Thread-safe.
  [[nodiscard]] LabeledMesh meshOf(int label) const;

 private:
  class Meshing;
  std::unique_ptr<const Meshing> meshing_;
};

}  // namespace sherd
