// The surface of the intact solid, which its fragments reuse.
#pragma once

#include <sherd/solid.h>

#include <array>
#include <cstdint>
#include <vector>

#include "mesh/mass_sums.h"
#include "surface/creases.h"
#include "surface/leaf_cells.h"
#include "voxelize/leaf_blocks.h"

namespace sherd {

/// The part of the intact solid's mesh that belongs to one leaf.
struct IntactLeaf {
  /// A corner of a triangle: the index of a vertex of the leaf, or of a leaf below it along the
  /// axes in the three highest bits: x 4, y 2, z 1.
  static constexpr unsigned kSlotBits = 29;
  using Corner = std::uint32_t;

  static std::size_t slotOf(Corner corner) { return corner >> kSlotBits; }
  static std::uint32_t vertexOf(Corner corner) { return corner & ((Corner{1} << kSlotBits) - 1); }

  /// [slots] index into LeafNeighbors of the leaf.
  static constexpr std::array<std::size_t, 8> kSlots{13, 12, 10, 9, 4, 3, 1, 0};

  LeafCells cells;
  std::vector<std::array<Corner, 3>> triangles;
  std::vector<double> areaSums;  ///< [triangles] area of triangles 0..i, world units
  MassSums mass;                 ///< of the triangles, about IntactSurface::reference
  Box box;                       ///< of the triangles' corners
  bool isWhole = false;  ///< the leaf and those below it are plain, so that the triangles are valid
                         ///< if all of these have one label
};

/// The intact surface, computed once for a solid that is fractured several times.  About 0.7 kB per
/// leaf and 280 bytes per cell that the surface passes through.
struct IntactSurface {
  std::vector<LeafNeighbors> neighborhoods;  ///< of the solid's leaves
  glm::dvec3 reference{0.0};                 ///< middleOf the solid
  Creases creases;
  bool isPiecewiseFlat = false;  ///< see simplify.h
  std::vector<IntactLeaf> leaves;

  /// Returns the corners of a leaf's triangle, world units.
  [[nodiscard]] std::array<glm::dvec3, 3> corners(std::size_t leaf, std::size_t triangle,
                                                  const GridFrame& frame) const {
    std::array<glm::dvec3, 3> at{};
    for (std::size_t k = 0; k < 3; ++k) {
      const IntactLeaf::Corner corner = leaves[leaf].triangles[triangle][k];
      const std::uint32_t of = neighborhoods[leaf][IntactLeaf::kSlots[IntactLeaf::slotOf(corner)]];
      at[k] = frame.worldFromIndex(leaves[of].cells.vertices[IntactLeaf::vertexOf(corner)]);
    }
    return at;
  }
};

/// Checks that an intact surface, if there is one, is of this solid.
///   throws  Error(usage)
void checkIntact(const IntactSurface* surface, const Solid& solid);

/// Returns the middle of the box of a solid's voxels, world units.
[[nodiscard]] glm::dvec3 middleOf(const Solid& solid);

}  // namespace sherd
