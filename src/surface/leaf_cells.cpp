// The cells of one leaf.
#include "surface/leaf_cells.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <bit>

#include "surface/cell_vertex.h"

namespace sherd {
namespace {

// Ambiguous faces are flipped in six sweeps, by axis and parity: each cell has one face in each
// sweep, and its state before a sweep does not depend on that sweep.
constexpr unsigned kSweeps = 6;

// Bits of the faces of a cell that are flipped for a label after the first `sweeps` sweeps.
unsigned flippedFaces(const Field& field, std::size_t leaf, const std::array<int, 3>& cell,
                      const CellLabels& labels, std::uint16_t label, unsigned sweeps = kSweeps) {
  unsigned flipped = 0;
  for (unsigned sweep = 0; sweep < sweeps; ++sweep) {
    const unsigned axis = sweep / 2;
    const bool high = (static_cast<unsigned>(cell[axis]) & 1) != sweep % 2;
    const unsigned face = 2 * axis + high;
    if (!((conflictingFaces(labels, label, flipped) >> face) & 1)) continue;
    std::array<int, 3> beside = cell;
    beside[axis] += high ? 1 : -1;
    const CellLabels theirs = field.labelsOf(leaf, beside[0], beside[1], beside[2]);
    const unsigned flippedTheirs = flippedFaces(field, leaf, beside, theirs, label, sweep);
    if ((conflictingFaces(theirs, label, flippedTheirs) >> (face ^ 1)) & 1) flipped |= 1u << face;
  }
  return flipped;
}

// Bits of the faces that are flipped, by corner for its label.
struct FlippedFaces {
  std::array<std::uint8_t, 8> faces{};
  bool dependsOnNeighbors = false;  // a face conflicts, so the neighbors' labels matter
};

FlippedFaces flippedByCorner(const Field& field, std::size_t leaf, const std::array<int, 3>& cell,
                             const CellLabels& labels) {
  FlippedFaces flipped;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::uint16_t label = labels[corner];
    if (label == 0 || conflictingFaces(labels, label, 0) == 0) continue;
    flipped.dependsOnNeighbors = true;
    flipped.faces[corner] =
        static_cast<std::uint8_t>(flippedFaces(field, leaf, cell, labels, label));
  }
  return flipped;
}

CellValues valuesOf(const Field& field, const openvdb::FloatGrid::ConstAccessor& distance,
                    std::size_t leaf, int x, int y, int z, const CellLabels& labels) {
  CellValues values;
  values.labels = labels;
  const bool isOnSurface = std::find(labels.begin(), labels.end(), 0) != labels.end();
  const std::uint16_t some = *std::max_element(labels.begin(), labels.end());
  const bool isCut =  // between two fragments
      std::any_of(labels.begin(), labels.end(), [&](auto l) { return l != 0 && l != some; });
  const openvdb::Coord low = field.solid().blocks->origins[leaf] + openvdb::Coord(x, y, z);
  std::array<std::size_t, 8> voxelIndex{};
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner >> 2, j = (corner >> 1) & 1, k = corner & 1;
    const auto c = static_cast<std::size_t>(corner);
    if (isOnSurface) values.toSurface[c] = distance.getValue(low + openvdb::Coord(i, j, k));
    if (isCut) voxelIndex[c] = field.voxelIndexNear(leaf, x + i, y + j, z + k);
  }
  for (std::size_t n = 0; isCut && n < 8; ++n) {
    if (labels[n] == 0) continue;
    const auto first = static_cast<std::size_t>(std::find(labels.begin(), labels.end(), labels[n]) -
                                                labels.begin());
    if (first < n) {
      values.toCut[n] = values.toCut[first];
      continue;
    }
    std::size_t of = Field::kNoVoxel;  // most corners are of one leaf
    Field::ToCut toCut;
    for (std::size_t c = 0; c < 8; ++c) {
      if (voxelIndex[c] / 512 != of) {
        of = voxelIndex[c] / 512;
        toCut = voxelIndex[c] == Field::kNoVoxel ? Field::ToCut{} : field.toCut(of, labels[n]);
      }
      values.toCut[n][c] = toCut.at(voxelIndex[c] % 512);
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

// [loop] the label whose sheet a loop is.
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

// True if a fragment has several sheets at one position of the cell.
bool isNonManifold(const CellSheets& sheets, const std::array<std::uint16_t, 24>& labelOf,
                   std::uint8_t position) {
  for (std::uint8_t l = 0; l < sheets.loops; ++l) {
    for (std::uint8_t k = 0; k < l; ++k) {
      if (labelOf[l] == labelOf[k] && labelOf[l] != Labels::kEroded &&
          sheets.positionOfLoop[l] == position && sheets.positionOfLoop[k] == position) {
        return true;
      }
    }
  }
  return false;
}

// Adds a cell of the intact solid, as one of a label.
void addIntact(const LeafCells& intact, std::size_t offset, std::uint16_t label, LeafCells& to) {
  Cell cell = intact.at(offset);
  const auto loops = [&](const auto& all) {
    return std::span(all).subspan(cell.firstLoop, cell.loops);
  };
  const auto vertices = loops(intact.vertices);
  const auto positionIds = loops(intact.positionIds);
  const std::uint32_t first = *std::min_element(positionIds.begin(), positionIds.end());
  cell.firstLoop = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), vertices.begin(), vertices.end());
  to.labels.insert(to.labels.end(), vertices.size(), label);
  for (const std::uint32_t id : positionIds)
    to.positionIds.push_back(to.positionCount + id - first);
  to.positionCount += cell.positions;
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

LeafCells cellsOf(const Field& field, std::size_t leaf, const LeafCells* intact) {
  LeafCells found;
  const LabelCube<9> corners = field.cornersOf(leaf);
  const PassedCells<9> passed = passedCells<9>(corners);
  std::size_t count = 0;
  for (const std::uint16_t row : passed.crossed)
    count += static_cast<std::size_t>(std::popcount(row));
  found.cells.reserve(count);
  found.vertices.reserve(count);
  found.labels.reserve(count);
  found.positionIds.reserve(count);
  const openvdb::FloatGrid::ConstAccessor distance = field.solid().distance->getConstAccessor();
  const openvdb::Coord& origin = field.solid().blocks->origins[leaf];
  for (std::uint32_t offset = 0; offset < 512; ++offset) {
    const openvdb::Coord at = coordFromOffset(offset);
    const auto row = static_cast<std::size_t>(at.x() * 9 + at.y());
    if (((passed.crossed[row] >> at.z()) & 1) == 0) continue;
    const CellLabels labels = labelsAt(corners, at);
    if (intact != nullptr && intact->isPlain && ((passed.cut[row] >> at.z()) & 1) == 0) {
      addIntact(*intact, offset, *std::max_element(labels.begin(), labels.end()), found);
      continue;
    }
    const CellSheets* const plain = plainSheetsOf(labels);
    CellSheets made;
    if (plain == nullptr) {
      const auto flipped = flippedByCorner(field, leaf, {at.x(), at.y(), at.z()}, labels);
      made = sheetsOf(labels, flipped.faces);
      found.isPlain &= !flipped.dependsOnNeighbors;
    }
    const CellSheets& sheets = plain != nullptr ? *plain : made;
    const Cell cell{static_cast<std::uint16_t>(offset), sheets.loops, sheets.positions,
                    static_cast<std::uint32_t>(found.vertices.size()), sheets.loopOf};
    const CellValues values = valuesOf(field, distance, leaf, at.x(), at.y(), at.z(), labels);
    const glm::dvec3 low(origin.x() + at.x(), origin.y() + at.y(), origin.z() + at.z());
    found.vertices.resize(found.vertices.size() + sheets.loops);
    found.positionIds.resize(found.vertices.size());
    const std::array<std::uint16_t, 24> labelOf = labelsOfLoops(sheets, labels);
    found.labels.insert(found.labels.end(), labelOf.begin(), labelOf.begin() + sheets.loops);
    for (std::uint8_t p = 0; p < sheets.positions; ++p) {
      if (isNonManifold(sheets, labelOf, p)) {
        found.nonManifold.push_back(found.positionCount + p);
        found.isPlain = false;
      }
      const CellVertex vertex = cellVertex(values, sheets, p, field.cut().snapWeight);
      const bool isJunction = vertex.target != vertex.at;
      if (isJunction) found.junctions.push_back({.target = low + vertex.target});
      for (std::uint8_t l = 0; l < sheets.loops; ++l) {
        if (sheets.positionOfLoop[l] != p) continue;
        if (isJunction) found.junctions.back().add(cell.firstLoop + l);
        found.vertices[cell.firstLoop + l] = low + vertex.at;
        found.positionIds[cell.firstLoop + l] = found.positionCount + p;
      }
    }
    found.positionCount += sheets.positions;
    found.add(cell);
  }
  return found;
}

namespace {

// Corner bit of each axis.
constexpr std::array<unsigned, 3> kBit{4, 2, 1};

// [axis][corner] the edge from a corner along an axis.
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
  std::array<std::uint16_t, 512> mineAt;  // by offset: most cells around an edge are the leaf's own
  for (std::size_t i = 0; i < mine.cells.size(); ++i) {
    mineAt[mine.cells[i].offset] = static_cast<std::uint16_t>(i);
  }
  for (const Cell& cell : mine.cells) {
    const openvdb::Coord at = coordFromOffset(cell.offset);
    const CellLabels labels = labelsAt(corners, at);
    for (unsigned axis = 0; axis < 3; ++axis) {
      if (!cell.isCrossed(kEdgeAlong[axis][0])) continue;
      const std::array<std::uint16_t, 2> label{labels[0], labels[kBit[axis]]};
      const unsigned b = (axis + 1) % 3, c = (axis + 2) % 3;
      // Cells around the edge, counter-clockwise seen from its far end.  The quad of the other side
      // is reversed from the same first corner, so that both have the same diagonals.
      constexpr std::array<std::array<int, 2>, 4> kRing{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
      std::array<InterfaceQuad, 2> quad{{{label[0], label[1], {}}, {label[1], label[0], {}}}};
      bool isComplete = true;
      for (std::size_t k = 0; k < 4; ++k) {
        openvdb::Coord low = at;
        low[static_cast<int>(b)] -= kRing[k][0];
        low[static_cast<int>(c)] -= kRing[k][1];
        const unsigned corner = (kRing[k][0] ? kBit[b] : 0) + (kRing[k][1] ? kBit[c] : 0);
        const bool isMine = (low.x() | low.y() | low.z()) >= 0;
        std::size_t of = leaf;
        const Cell* around = nullptr;
        if (isMine) {
          around = &mine.cells[mineAt[offsetFromCoord(low)]];
        } else {
          const std::size_t voxelIndex = field.voxelIndexNear(leaf, low.x(), low.y(), low.z());
          isComplete = voxelIndex != Field::kNoVoxel;
          if (!isComplete) break;
          of = voxelIndex / 512;
          around = &all.leaves[of]->at(voxelIndex % 512);
        }
        const std::uint32_t first = all.firstVertex[of] + around->firstLoop;
        const auto& loops = around->loopOf[kEdgeAlong[axis][corner]];
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
