// What surfaces pass through one cell: a cube of eight voxel centres with a label each.
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

/// The surfaces of a cell.  An edge between two labels is crossed by a surface; on a face of the
/// cell crossed edges are joined, so that those of one label form loops, each a sheet of that
/// label's surface that needs a vertex.  Sheets that are joined, through whatever label, share the
/// vertex's position.
///
/// Where a label lies on two opposite corners of a face only, its sheets may pass between them or
/// round them.  They part it where the other corners have one label and that is higher (0, the
/// outside, counts as the highest), so that both sides of such a surface see it alike; where the
/// others are two labels, those are parted.
struct CellSheets {
  static constexpr std::uint8_t kNone = 255;

  std::uint8_t loops = 0;      ///< over all labels but 0
  std::uint8_t positions = 0;  ///< how many places they need
  std::array<std::array<std::uint8_t, 2>, 12>
      loopOf{};  ///< of a crossed edge, for the label of its lower and higher corner; else kNone
  std::array<std::uint8_t, 12> positionOf{};  ///< of a crossed edge; else kNone
  std::array<std::uint8_t, 24> positionOfLoop{};
};

/// Faces: 2a is the one at the low end of axis a, 2a + 1 that at the high end.
inline constexpr unsigned kCellFaces = 6;

/// Bits of the faces on which a label's four crossed edges all belong to one loop.  Where the cells
/// on both sides of a face find so, the label's quads would share one edge four times: then both
/// must turn the face, which is to join its corners the other way.  That parts the loop, and joins
/// none.
///   turned  bits of faces that are turned already
[[nodiscard]] unsigned doubledFaces(const CellLabels& labels, std::uint16_t label, unsigned turned);

/// The sheets of a cell.
///   turned  [corner whose label] bits of the faces that are turned for it
[[nodiscard]] CellSheets sheetsOf(const CellLabels& labels,
                                  const std::array<std::uint8_t, 8>& turned = {});

}  // namespace sherd
