// One mesh of all labels, of which each fragment takes its faces.
#pragma once

#include <sherd/labels.h>
#include <sherd/solid.h>

#include <memory>
#include <span>

#include "surface/complex.h"
#include "surface/cut.h"

namespace sherd {

struct UnbrokenSurface;

/// All labels meshed at once: a dual mesh over the cells between voxel centres, with a quad, split
/// in two, for each pair of face neighbours of different labels.  So what two fragments share is
/// one set of faces, seen from both sides, vertex for vertex and bit for bit; and a face's two
/// labels are known, not guessed.
///
/// A cell has a place per surface that passes, and a vertex per sheet (see cell.h): the mean of the
/// crossings of its edges by the solid's surface or by the cut, as in surface nets; where surfaces
/// of several pairs of labels meet it lies where their planes do, so that rims are sharp.
///   source  Gibson, Constrained Elastic Surface Nets, 1998; Ju et al., Dual Contouring of Hermite
///           Data, 2002; Wenger, Isosurfaces, 2013 (cells that share an ambiguous face)
class InterfaceMeshes {
 public:
  /// Of labels 1..fragments.  All that is given is used until the end.
  ///   rounds    of the solid's leaves
  ///   unbroken  of this solid, or null: what does not change is taken over, and the meshes are
  ///             equal
  InterfaceMeshes(const Solid& solid, const Labels& labels, const Cut& cut,
                  std::span<const LeafRound> rounds, int fragments,
                  const UnbrokenSurface* unbroken = nullptr, const Progress* progress = nullptr);
  ~InterfaceMeshes();
  InterfaceMeshes(const InterfaceMeshes&) = delete;
  InterfaceMeshes& operator=(const InterfaceMeshes&) = delete;

  /// A label's mesh, put together anew each time: they take as much memory as what they are made
  /// of.  Any thread may ask.
  [[nodiscard]] LabelledMesh meshOf(int label) const;

 private:
  class Meshing;
  std::unique_ptr<const Meshing> meshing_;
};

}  // namespace sherd
