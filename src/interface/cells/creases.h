// Vertices of the intact solid's surface at the creases of its input.
#pragma once

#include <sherd/progress.h>
#include <sherd/solid.h>

#include <cstdint>
#include <span>
#include <vector>

#include "interface/cells/cell.h"
#include "interface/cells/crease_vertex.h"
#include "interface/cells/input_crossings.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {

/// Whether Creases keep the crossings that they are made of.
enum class KeepCrossings { no, yes };

/// The creases of a solid: the positions that the input's own triangles give to vertices of cells
/// without cracks.  They are found once, of the intact solid, so that they depend on no fracture.
///
/// A cell's edges cross triangles at points with normals.  The vertex is the point nearest to their
/// planes, and there the nearest of the input.  Where its planes meet elsewhere and its triangles
/// would cross others, it moves back into the cell, and else to where the distances put it.
///   source  Ju, Losasso, Schaefer, Warren: Dual Contouring of Hermite Data, 2002
class Creases {
 public:
  Creases() = default;

  ///   neighborhoods  of the solid's leaves
  ///   throws         Error(cancelled)
  Creases(const Solid& solid, std::span<const LeafNeighbors> neighborhoods,
          const Progress* progress, KeepCrossings keep = KeepCrossings::no);

  /// Returns the vertices in a leaf, ascending by offset.
  ///   origin  lowest voxel of the leaf
  [[nodiscard]] std::span<const CreaseVertex> of(const openvdb::Coord& origin) const;

  /// Returns the crossings of a leaf's cells that were kept, which spares fractures to find them.
  [[nodiscard]] std::span<const KnownCrossing> crossings(const openvdb::Coord& origin) const;

 private:
  class Finder;

  // Returns the index of a leaf in origins_, or their number.
  [[nodiscard]] std::size_t indexOf(const openvdb::Coord& origin) const;

  std::vector<openvdb::Coord> origins_;  // ascending: of leaves with vertices or crossings
  std::vector<std::vector<CreaseVertex>> vertices_;    // [origins]
  std::vector<std::vector<KnownCrossing>> crossings_;  // [origins], or empty
};

/// The vertices of one leaf, looked up by ascending offsets.
class CreasesOfLeaf {
 public:
  ///   creases  or null
  CreasesOfLeaf(const Creases* creases, const openvdb::Coord& origin)
      : left_(creases != nullptr ? creases->of(origin) : std::span<const CreaseVertex>()) {}

  /// Returns the vertex of a cell's position, or null.
  [[nodiscard]] const CreaseVertex* find(std::uint32_t offset, const CellSheets& sheets,
                                         unsigned position);

 private:
  std::span<const CreaseVertex> left_;
};

}  // namespace sherd
