// The surface of the intact solid, which its fragments reuse.
#pragma once

#include <sherd/solid.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "interface/cells/creases.h"
#include "interface/cells/leaf_cells.h"
#include "mesh/mass_sums.h"
#include "voxelize/leaves/leaf_blocks.h"

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

  /// A quad, with the members of InterfaceQuad.
  struct Quad {
    std::array<Corner, 4> corner{};
    std::uint16_t edge = 0;
    QuadSplit split = QuadSplit::first;  ///< settled
  };

  [[nodiscard]] std::size_t triangles() const { return 2 * quads.size(); }

  LeafCells cells;
  std::vector<Quad> quads;                   ///< ascending by edge
  std::vector<std::array<double, 2>> areas;  ///< [quads] of the two triangles, world units
  std::vector<double> areaSums;              ///< [2*quads] area of triangles 0..i
  std::vector<MassSums> octants;  ///< [8] of the triangles, about IntactSurface::reference; empty
                                  ///< without triangles
  MassSums mass;                  ///< their sum
  Box box;                        ///< of the triangles' corners
  bool isWhole = false;  ///< the leaf and those below it are plain, so that the triangles are valid
                         ///< if all of these have one label
};

/// Returns the sum of a leaf's octants.
[[nodiscard]] inline MassSums sumOf(std::span<const MassSums> octants,
                                    const glm::dvec3& reference) {
  MassSums sum(reference);
  for (const MassSums& octant : octants) sum.add(octant);
  return sum;
}

/// The intact surface, computed once for a solid that is fractured several times.  About 0.8 kB per
/// leaf, 0.8 kB more where there are triangles, 290 bytes per cell that the surface passes through,
/// and 56 per edge between voxels whose crossing creases are made of.
struct IntactSurface {
  ConstFloatGridPtr distance;                ///< the solid's, by which it is known again
  std::vector<LeafNeighbors> neighborhoods;  ///< of the solid's leaves
  glm::dvec3 reference{0.0};                 ///< middleOf the solid
  Creases creases;
  bool isPiecewiseFlat = false;  ///< see flat_input.h
  std::vector<IntactLeaf> leaves;

  /// Returns the corners of a leaf's triangle, world units.
  [[nodiscard]] std::array<glm::dvec3, 3> corners(std::size_t leaf, std::size_t triangle,
                                                  const GridFrame& frame) const {
    std::array<glm::dvec3, 3> at{};
    const IntactLeaf::Quad& quad = leaves[leaf].quads[triangle / 2];
    for (std::size_t k = 0; k < 3; ++k) {
      const IntactLeaf::Corner corner = trianglesOf(quad.corner, quad.split)[triangle % 2][k];
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
