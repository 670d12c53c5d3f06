// The cells of one leaf.
#include "surface/leaf_cells.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <bit>

#include "surface/cell_vertex.h"

namespace sherd {
namespace {

// Faces are turned in six sweeps, by axis and parity, so that a cell has one face in each and its
// state before a sweep does not depend on that sweep.
constexpr unsigned kSweeps = 6;

// The faces of a cell that are turned for a label before a sweep.
unsigned turnedFaces(const Field& field, std::size_t leaf, const std::array<int, 3>& cell,
                     const CellLabels& labels, std::uint16_t label, unsigned sweeps = kSweeps) {
  unsigned turned = 0;
  for (unsigned sweep = 0; sweep < sweeps; ++sweep) {
    const unsigned axis = sweep / 2;
    const bool high = (static_cast<unsigned>(cell[axis]) & 1) != sweep % 2;
    const unsigned face = 2 * axis + high;
    if (!((doubledFaces(labels, label, turned) >> face) & 1)) continue;
    std::array<int, 3> beside = cell;
    beside[axis] += high ? 1 : -1;
    const CellLabels theirs = field.labelsOf(leaf, beside[0], beside[1], beside[2]);
    const unsigned turnedTheirs = turnedFaces(field, leaf, beside, theirs, label, sweep);
    if ((doubledFaces(theirs, label, turnedTheirs) >> (face ^ 1)) & 1) turned |= 1u << face;
  }
  return turned;
}

// The faces that are turned for the label of each corner.
struct Turned {
  std::array<std::uint8_t, 8> faces{};
  bool mayTurn = false;  // it takes a look at the neighbours to tell
};

Turned turnedByCorner(const Field& field, std::size_t leaf, const std::array<int, 3>& cell,
                      const CellLabels& labels) {
  Turned turned;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::uint16_t label = labels[corner];
    if (label == 0 || doubledFaces(labels, label, 0) == 0) continue;
    turned.mayTurn = true;
    turned.faces[corner] = static_cast<std::uint8_t>(turnedFaces(field, leaf, cell, labels, label));
  }
  return turned;
}

CellValues valuesOf(const Field& field, const openvdb::FloatGrid::ConstAccessor& distance,
                    std::size_t leaf, int x, int y, int z, const CellLabels& labels) {
  CellValues values;
  values.labels = labels;
  const std::uint16_t some = *std::max_element(labels.begin(), labels.end());
  const bool isCut =  // between two fragments
      std::any_of(labels.begin(), labels.end(), [&](auto l) { return l != 0 && l != some; });
  const openvdb::Coord low = field.solid().blocks.origins[leaf] + openvdb::Coord(x, y, z);
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner >> 2, j = (corner >> 1) & 1, k = corner & 1;
    const auto c = static_cast<std::size_t>(corner);
    values.toSurface[c] = distance.getValue(low + openvdb::Coord(i, j, k));
    if (!isCut) continue;
    const std::size_t place = field.placeNear(leaf, x + i, y + j, z + k);
    for (std::size_t n = 0; n < 8; ++n) {
      if (labels[n] == 0) continue;
      const auto first = static_cast<std::size_t>(
          std::find(labels.begin(), labels.begin() + static_cast<std::ptrdiff_t>(n), labels[n]) -
          labels.begin());
      values.toCut[n][c] = first < n ? values.toCut[first][c] : field.toCut(place, labels[n]);
    }
  }
  return values;
}

CellLabels labelsAt(const LabelCube<9>& corners, const openvdb::Coord& cell) {
  CellLabels labels;
  const auto low = static_cast<std::size_t>((cell.x() * 9 + cell.y()) * 9 + cell.z());
  for (std::size_t corner = 0; corner < 8; ++corner) {
    labels[corner] = corners[low + (corner >> 2) * 81 + ((corner >> 1) & 1) * 9 + (corner & 1)];
  }
  return labels;
}

// Whose sheets the loops of a cell are.
std::array<std::uint16_t, 24> labelsOfLoops(const CellSheets& sheets, const CellLabels& labels) {
  std::array<std::uint16_t, 24> labelOf{};
  for (std::size_t e = 0; e < 12; ++e) {
    for (std::size_t side : {0, 1}) {
      const std::uint8_t loop = sheets.loopOf[e][side];
      if (loop != CellSheets::kNone) labelOf[loop] = labels[kCellEdges[e][side]];
    }
  }
  return labelOf;
}

// Does a fragment have several sheets at one place of the cell?
bool isCrowded(const CellSheets& sheets, const std::array<std::uint16_t, 24>& labelOf,
               std::uint8_t position) {
  for (std::uint8_t l = 0; l < sheets.loops; ++l) {
    for (std::uint8_t k = 0; k < l; ++k) {
      if (labelOf[l] == labelOf[k] && labelOf[l] != Labels::kWorn &&
          sheets.positionOfLoop[l] == position && sheets.positionOfLoop[k] == position) {
        return true;
      }
    }
  }
  return false;
}

// Add a cell as it is in the unbroken solid.
void addUnbroken(const LeafCells& unbroken, std::size_t offset, LeafCells& to) {
  Cell cell = unbroken.at(offset);
  const auto loops = [&](const auto& all) {
    return std::span(all).subspan(cell.firstLoop, cell.loops);
  };
  const auto vertices = loops(unbroken.vertices);
  const auto places = loops(unbroken.places);
  const std::uint32_t first = *std::min_element(places.begin(), places.end());
  cell.firstLoop = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), vertices.begin(), vertices.end());
  for (const std::uint32_t place : places) to.places.push_back(to.placeCount + place - first);
  to.placeCount += cell.positions;
  to.add(cell);
}

}  // namespace

std::optional<std::uint16_t> onlyLabelOf(const Field& field, std::size_t leaf) {
  std::uint16_t found = 0;
  for (const std::uint16_t label : field.cornersOf(leaf)) {
    if (label == 0 || label == found) continue;
    if (found != 0) return std::nullopt;
    found = label;
  }
  return found;
}

LeafCells cellsOf(const Field& field, std::size_t leaf, const LeafCells* unbroken) {
  LeafCells found;
  const LabelCube<9> corners = field.cornersOf(leaf);
  const PassedCells<9> passed = passedCells<9>(corners);
  std::size_t count = 0;
  for (const std::uint16_t row : passed.crossed)
    count += static_cast<std::size_t>(std::popcount(row));
  found.cells.reserve(count);
  found.vertices.reserve(count);
  found.places.reserve(count);
  const openvdb::FloatGrid::ConstAccessor distance = field.solid().distance->getConstAccessor();
  const openvdb::Coord& origin = field.solid().blocks.origins[leaf];
  for (std::uint32_t offset = 0; offset < 512; ++offset) {
    const openvdb::Coord at = coordFromOffset(offset);
    const auto row = static_cast<std::size_t>(at.x() * 9 + at.y());
    if (((passed.crossed[row] >> at.z()) & 1) == 0) continue;
    if (unbroken != nullptr && unbroken->isPlain && ((passed.cut[row] >> at.z()) & 1) == 0) {
      addUnbroken(*unbroken, offset, found);
      continue;
    }
    const CellLabels labels = labelsAt(corners, at);
    const auto turned = turnedByCorner(field, leaf, {at.x(), at.y(), at.z()}, labels);
    const CellSheets sheets = sheetsOf(labels, turned.faces);
    found.isPlain &= !turned.mayTurn;
    const Cell cell{static_cast<std::uint16_t>(offset), sheets.loops, sheets.positions,
                    static_cast<std::uint32_t>(found.vertices.size()), sheets.loopOf};
    const CellValues values = valuesOf(field, distance, leaf, at.x(), at.y(), at.z(), labels);
    const glm::dvec3 low(origin.x() + at.x(), origin.y() + at.y(), origin.z() + at.z());
    found.vertices.resize(found.vertices.size() + sheets.loops);
    found.places.resize(found.vertices.size());
    const std::array<std::uint16_t, 24> labelOf = labelsOfLoops(sheets, labels);
    for (std::uint8_t p = 0; p < sheets.positions; ++p) {
      if (isCrowded(sheets, labelOf, p)) {
        found.crowded.push_back(found.placeCount + p);
        found.isPlain = false;
      }
      const CellVertex vertex = cellVertex(values, sheets, p, field.cut().stairs);
      const bool isJunction = vertex.wanted != vertex.at;
      if (isJunction) found.junctions.push_back({{}, low + vertex.wanted});
      for (std::uint8_t l = 0; l < sheets.loops; ++l) {
        if (sheets.positionOfLoop[l] != p) continue;
        if (isJunction) found.junctions.back().vertices.push_back(cell.firstLoop + l);
        found.vertices[cell.firstLoop + l] = low + vertex.at;
        found.places[cell.firstLoop + l] = found.placeCount + p;
      }
    }
    found.placeCount += sheets.positions;
    found.add(cell);
  }
  return found;
}

namespace {

// Corners bits of the axes.
constexpr std::array<unsigned, 3> kBit{4, 2, 1};

// [axis][corner] the edge that leads from a corner along an axis
constexpr std::array<std::array<std::uint8_t, 8>, 3> kEdgeAlong = [] {
  std::array<std::array<std::uint8_t, 8>, 3> edges{};
  for (std::size_t e = 0; e < 12; ++e) {
    edges[e / 4][kCellEdges[e][0]] = static_cast<std::uint8_t>(e);
  }
  return edges;
}();

}  // namespace

std::vector<InterfaceQuad> quadsOf(const Field& field, const AllCells& all, std::size_t leaf) {
  std::vector<InterfaceQuad> quads;
  const LeafCells& mine = *all.leaves[leaf];
  quads.reserve(2 * mine.cells.size());
  const LabelCube<9> corners = field.cornersOf(leaf);
  for (const Cell& cell : mine.cells) {
    const openvdb::Coord at = coordFromOffset(cell.offset);
    const CellLabels labels = labelsAt(corners, at);
    for (unsigned axis = 0; axis < 3; ++axis) {
      if (!cell.isCrossed(kEdgeAlong[axis][0])) continue;
      const std::array<std::uint16_t, 2> label{labels[0], labels[kBit[axis]]};
      const unsigned b = (axis + 1) % 3, c = (axis + 2) % 3;
      // Round the edge as seen from its far end, counterclockwise; the other way round from the
      // near one, from the same corner on: the same diagonals.
      constexpr std::array<std::array<int, 2>, 4> kRing{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
      std::array<InterfaceQuad, 2> quad{{{label[0], label[1], {}}, {label[1], label[0], {}}}};
      bool isComplete = true;
      for (std::size_t k = 0; k < 4; ++k) {
        openvdb::Coord low = at;
        low[static_cast<int>(b)] -= kRing[k][0];
        low[static_cast<int>(c)] -= kRing[k][1];
        const unsigned corner = (kRing[k][0] ? kBit[b] : 0) + (kRing[k][1] ? kBit[c] : 0);
        const bool isMine = (low.x() | low.y() | low.z()) >= 0;
        const std::size_t place = isMine ? leaf * 512 + offsetFromCoord(low)
                                         : field.placeNear(leaf, low.x(), low.y(), low.z());
        isComplete = place != Field::kNowhere;
        if (!isComplete) break;
        const LeafCells& theirs = *all.leaves[place / 512];
        const Cell& own = theirs.at(place % 512);
        const std::uint32_t first = all.firstVertex[place / 512] + own.firstLoop;
        const auto& loops = own.loopOf[kEdgeAlong[axis][corner]];
        quad[0].vertex[k] = first + loops[0];
        quad[1].vertex[(4 - k) % 4] = first + loops[1];
      }
      for (const InterfaceQuad& side : quad) {
        if (side.label != 0 && isComplete) quads.push_back(side);
      }
    }
  }
  quads.shrink_to_fit();
  return quads;
}

}  // namespace sherd
