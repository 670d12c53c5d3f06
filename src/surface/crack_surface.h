// The surfaces between fragments, continued beyond the solid.
#pragma once

#include <sherd/labels.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "surface/cut.h"
#include "voxelize/leaf_blocks.h"

namespace sherd {

/// A triangle between two labels, counter-clockwise seen from outside `front`.
struct CrackFace {
  glm::uvec3 corner{0};
  std::uint16_t front = 0;  ///< the lower label
  std::uint16_t back = 0;   ///< Labels::kEroded for the surface of eroded voxels
};

/// Triangles that share vertices, also where more than two labels meet.
struct CrackSurface {
  std::vector<glm::dvec3> vertices;  ///< world units
  std::vector<CrackFace> faces;
};

[[nodiscard]] std::vector<glm::uvec3> trianglesOf(const CrackSurface& cracks);

/// Returns the labels with one on every voxel of the exterior band that is connected to an inside
/// voxel: of a voxel near several fragments the one whose cell it lies in, so that a planar cut
/// stays a plane beyond the solid.
///   cut  of the labels, with CutExtent::exact
[[nodiscard]] Labels labelsBeyond(const Solid& solid, const Labels& labels, const Cut& cut,
                                  std::span<const LeafNeighbors> neighborhoods);

/// Returns the surfaces between the labels inside and in the exterior band, which overhang the
/// solid's surface by about half a voxel to three voxels: the dual mesh of interface_mesh.h without
/// the original surface.
///   beyond  labelsBeyond of the labels
///   cut     as above
///   throws  Error(cancelled)
[[nodiscard]] CrackSurface crackSurface(const Solid& solid, const Labels& beyond, const Cut& cut,
                                        std::span<const LeafNeighbors> neighborhoods,
                                        const Progress* progress = nullptr);

/// Returns the surface with its nearly planar regions as polygons, triangulated, and the lines
/// between them with fewer vertices.  Where polygons would cross each other, they keep more.
///   tolerance  distance from planes and lines, world units
///   seed       of displacements by a thousandth of it, after which no vertex lies in the plane of
///   a
///              face that it does not belong to
///   throws     Error(cancelled)
[[nodiscard]] CrackSurface simplified(const CrackSurface& cracks, double tolerance,
                                      std::uint64_t seed, const Progress* progress = nullptr);

}  // namespace sherd
