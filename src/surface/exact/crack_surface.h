// The surfaces between fragments, continued beyond the solid.
#pragma once

#include <sherd/labels.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <span>

#include "cut/cut.h"
#include "remesh/complex.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// Returns the labels with one on every voxel of the exterior band that is connected to an inside
/// voxel: of a voxel near several fragments the one whose cell it lies in, so that a planar cut
/// stays a plane beyond the solid.
///   cut  of the labels, with CutExtent::exact
[[nodiscard]] Labels labelsBeyond(const Solid& solid, const Labels& labels, const Cut& cut,
                                  std::span<const LeafNeighbors> neighborhoods);

/// Where cracks end, at cells that reach beyond the exterior band.
enum class CrackEnds {
  quads,      ///< at the last quad without a corner there
  halfQuads,  ///< at the last triangle: a little farther out, where a crack may not reach the
              ///< surface else
};

/// Returns the surfaces between the labels inside and in the exterior band, which overhang the
/// solid's surface by about half a voxel to three voxels: the dual mesh of interface_mesh.h without
/// the original surface.  Of a face's labels the front is the lower, and the back may be
/// Labels::kEroded, for the surface of eroded voxels.
///   beyond  labelsBeyond of the labels
///   cut     as above
///   throws  Error(cancelled)
[[nodiscard]] LabeledComplex crackSurface(const Solid& solid, const Labels& beyond, const Cut& cut,
                                          std::span<const LeafNeighbors> neighborhoods,
                                          const Progress* progress = nullptr,
                                          CrackEnds ends = CrackEnds::quads);

}  // namespace sherd
