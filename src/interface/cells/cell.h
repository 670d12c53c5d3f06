// The surfaces in one cell: a cube of eight voxel centers with a label each.
#pragma once

#include <array>
#include <cstdint>

namespace sherd {

/// Labels at the corners of a cell, corner 4x + 2y + z.
using CellLabels = std::array<std::uint16_t, 8>;

/// The two corners of a cell's edge, the lower first: edges 4a..4a+3 run along axis a.
inline constexpr std::array<std::array<std::uint8_t, 2>, 12> kCellEdges{{{0, 4},
                                                                         {1, 5},
                                                                         {2, 6},
                                                                         {3, 7},
                                                                         {0, 2},
                                                                         {1, 3},
                                                                         {4, 6},
                                                                         {5, 7},
                                                                         {0, 1},
                                                                         {2, 3},
                                                                         {4, 5},
                                                                         {6, 7}}};

/// The surfaces of a cell.  A surface crosses each edge between two labels.  On each face of the
/// cell the crossed edges of a label are linked, so that they form loops.  A loop is a sheet of the
/// label's surface and needs one vertex.  Sheets that share a crossed edge share the position of
/// their vertices.
///
/// A face is ambiguous for a label that lies on two opposite corners only: its sheets either
/// separate or connect the two corners.  They separate them where the other corners have one label
/// and that is higher (0, the outside, counts as the highest), so that both labels resolve the face
/// alike.  They connect them where the other corners have two labels.
struct CellSheets {
  static constexpr std::uint8_t kNone = 255;

  std::uint8_t loops = 0;      ///< over all labels but 0
  std::uint8_t positions = 0;  ///< distinct positions of their vertices
  std::array<std::array<std::uint8_t, 2>, 12>
      loopOf{};  ///< of a crossed edge, for the labels of its lower and higher corner; else kNone
  std::array<std::uint8_t, 12> positionOf{};  ///< of a crossed edge; else kNone
  std::array<std::uint8_t, 24> positionOfLoop{};
};

/// Face 2a lies at the low end of axis a, face 2a + 1 at the high end.
inline constexpr unsigned kCellFaces = 6;

/// Returns the bits of the ambiguous faces on which all four crossed edges belong to one loop of
/// the label.  If that holds in the cells on both sides of a face, four quads of the label would
/// share an edge; then both cells must flip the resolution of the face.  The flip splits the loop
/// and merges none.
///   flipped  bits of the faces whose resolution is flipped already
[[nodiscard]] unsigned conflictingFaces(const CellLabels& labels, std::uint16_t label,
                                        unsigned flipped);

/// Returns the sheets of a cell.
///   flipped  [first corner of a label] bits of the faces whose resolution is flipped for it
[[nodiscard]] CellSheets sheetsOf(const CellLabels& labels,
                                  const std::array<std::uint8_t, 8>& flipped = {});

/// Returns the sheets of a cell with at most two labels beside 0, none of which has an ambiguous
/// face, from a table of 0.4 MB; nullptr for any other.
[[nodiscard]] const CellSheets* plainSheetsOf(const CellLabels& labels);

}  // namespace sherd
