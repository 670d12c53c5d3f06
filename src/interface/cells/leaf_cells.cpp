// The cells of one leaf.
#include "interface/cells/leaf_cells.h"

#include <algorithm>
#include <bit>

#include "interface/cells/cell_values.h"
#include "interface/cells/cell_vertex.h"
#include "interface/cells/creases.h"

namespace sherd {
namespace {

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
  for (std::uint32_t l = 0; l < cell.loops; ++l) {
    to.fromIntact[cell.firstLoop + l] = static_cast<std::uint16_t>(to.vertices.size() + l);
  }
  const auto loops = [&](const auto& all) {
    return std::span(all).subspan(cell.firstLoop, cell.loops);
  };
  const auto vertices = loops(intact.vertices);
  const auto positionIds = loops(intact.positionIds);
  const auto ranks = loops(intact.ranks);
  const std::uint32_t first = *std::min_element(positionIds.begin(), positionIds.end());
  cell.firstLoop = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), vertices.begin(), vertices.end());
  to.labels.insert(to.labels.end(), vertices.size(), label);
  to.ranks.insert(to.ranks.end(), ranks.begin(), ranks.end());
  for (const std::uint32_t id : positionIds)
    to.positionIds.push_back(to.positionCount + id - first);
  to.positionCount += cell.positions;
  to.add(cell);
}

// Adds a cell.
//   low       its lowest corner, index space
//   vertexOf  returns the vertex of a position
template <class VertexOf>
void addCell(std::uint32_t offset, const glm::dvec3& low, const CellLabels& labels,
             const CellSheets& sheets, LeafCells& to, const VertexOf& vertexOf) {
  const Cell cell{static_cast<std::uint16_t>(offset), sheets.loops, sheets.positions,
                  static_cast<std::uint32_t>(to.vertices.size()), sheets.loopOf};
  to.vertices.resize(to.vertices.size() + sheets.loops);
  to.positionIds.resize(to.vertices.size());
  to.ranks.resize(to.vertices.size());
  const std::array<std::uint16_t, 24> labelOf = labelsOfLoops(sheets, labels);
  to.labels.insert(to.labels.end(), labelOf.begin(), labelOf.begin() + sheets.loops);
  for (std::uint8_t p = 0; p < sheets.positions; ++p) {
    if (isNonManifold(sheets, labelOf, p)) {
      to.nonManifold.push_back(to.positionCount + p);
      to.isPlain = false;
    }
    const CellVertex vertex = vertexOf(p);
    const bool isJunction = vertex.target != vertex.at;
    if (isJunction) {
      to.junctions.push_back(
          {.target = low + vertex.target, .normal = vertex.normal, .isOnCrease = vertex.rank > 1});
    }
    for (std::uint8_t l = 0; l < sheets.loops; ++l) {
      if (sheets.positionOfLoop[l] != p) continue;
      if (isJunction) to.junctions.back().add(cell.firstLoop + l);
      to.vertices[cell.firstLoop + l] = low + vertex.at;
      to.ranks[cell.firstLoop + l] = vertex.rank;
      to.positionIds[cell.firstLoop + l] = to.positionCount + p;
    }
  }
  to.positionCount += sheets.positions;
  to.add(cell);
}

// Removes other cells than some of the leaf.
void keepOnly(const CellBits& cells, PassedCells<9>& passed) {
  for (std::size_t x = 0; x < 8; ++x) {
    for (std::size_t y = 0; y < 8; ++y)
      passed.crossed[x * 9 + y] &= static_cast<std::uint16_t>((cells[x] >> (8 * y)) & 0xff);
  }
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

LeafCells cellsOf(const Field& field, std::size_t leaf, const LeafCells* intact,
                  const CellBits* only) {
  LeafCells found;
  if (intact != nullptr) found.fromIntact.assign(intact->vertices.size(), LeafCells::kNotIntact);
  const LabelCube<9> corners = field.cornersOf(leaf);
  PassedCells<9> passed = passedCells<9>(corners);
  if (only != nullptr) keepOnly(*only, passed);
  std::size_t count = 0;
  for (const std::uint16_t row : passed.crossed)
    count += static_cast<std::size_t>(std::popcount(row));
  if (count == 0) return found;
  found.cells.reserve(count);
  found.vertices.reserve(count);
  found.labels.reserve(count);
  found.ranks.reserve(count);
  found.positionIds.reserve(count);
  const DistanceCube distance = distancesOf(field, leaf);
  const openvdb::Coord& origin = field.solid().blocks->origins[leaf];
  InputCrossings input(field.solid(), origin,
                       field.creases() != nullptr ? field.creases()->crossings(origin)
                                                  : std::span<const KnownCrossing>());
  CreasesOfLeaf creases(field.creases(), origin);
  for (std::uint32_t offset = 0; offset < 512; ++offset) {
    const openvdb::Coord at = coordFromOffset(offset);
    const auto row = static_cast<std::size_t>(at.x() * 9 + at.y());
    if (((passed.crossed[row] >> at.z()) & 1) == 0) continue;
    const CellLabels labels = labelsAt(corners, at);
    const bool isCut = ((passed.cut[row] >> at.z()) & 1) != 0;
    if (intact != nullptr && intact->isPlain && !isCut) {
      addIntact(*intact, offset, *std::max_element(labels.begin(), labels.end()), found);
      continue;
    }
    found.made[offset / 64] |= std::uint64_t{1} << (offset % 64);
    const CellSheets* const plain = plainSheetsOf(labels);
    ResolvedSheets resolved;
    if (plain == nullptr) {
      resolved = resolvedSheets(field, leaf, at, labels);
      found.isPlain &= !resolved.dependsOnNeighbors;
    }
    const CellSheets& sheets = plain != nullptr ? *plain : resolved.sheets;
    CellValues values = valuesOf(field, distance, leaf, at, labels);
    const bool isBoundary = isCut && std::find(labels.begin(), labels.end(), 0) != labels.end();
    if (isBoundary && field.creases() != nullptr) addInput(input, at, sheets, values);
    const glm::dvec3 low(origin.x() + at.x(), origin.y() + at.y(), origin.z() + at.z());
    addCell(offset, low, labels, sheets, found, [&](std::uint8_t p) {
      const CreaseVertex* const crease = isCut ? nullptr : creases.find(offset, sheets, p);
      if (crease != nullptr) return CellVertex{crease->at, crease->at, crease->rank, {}};
      return cellVertex(values, sheets, p, field.cut().snapWeight);
    });
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

// Steps down along the next two axes to the cells around an edge, counter-clockwise seen from its
// far end.
constexpr std::array<std::array<int, 2>, 4> kRing{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};

openvdb::Coord cellAround(const openvdb::Coord& at, unsigned axis, std::size_t k) {
  openvdb::Coord low = at;
  low[static_cast<int>((axis + 1) % 3)] -= kRing[k][0];
  low[static_cast<int>((axis + 2) % 3)] -= kRing[k][1];
  return low;
}

// The diagonal along a crease.  A crease along a side of the quad does not matter.
QuadSplit splitBy(const std::array<int, 4>& rank) {
  const int first = rank[0] + rank[2], second = rank[1] + rank[3];
  if (first == second) return QuadSplit::shorter;
  return first > second ? QuadSplit::first : QuadSplit::second;
}

}  // namespace

std::vector<InterfaceQuad> quadsOf(const Field& field, const AllCells& all, std::size_t leaf,
                                   const LeafEdges* edges) {
  std::vector<InterfaceQuad> quads;
  const LeafCells& mine = *all.leaves[leaf];
  if (edges == nullptr) quads.reserve(2 * mine.cells.size());
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
      if (edges != nullptr && !has((*edges)[axis], cell.offset)) continue;
      const std::array<std::uint16_t, 2> label{labels[0], labels[kBit[axis]]};
      const unsigned b = (axis + 1) % 3, c = (axis + 2) % 3;
      // The quad of the other side is reversed from the same first corner, so that both have the
      // same diagonals.
      std::array<InterfaceQuad, 2> quad{{{label[0], label[1], {}}, {label[1], label[0], {}}}};
      std::array<int, 4> rank{};
      bool isComplete = true;
      for (std::size_t k = 0; k < 4; ++k) {
        const openvdb::Coord low = cellAround(at, axis, k);
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
        const std::uint8_t loop = loops[0] != CellSheets::kNone ? loops[0] : loops[1];
        rank[k] = all.leaves[of]->ranks[around->firstLoop + loop];
        quad[0].vertex[k] = first + loops[0];
        quad[1].vertex[(4 - k) % 4] = first + loops[1];
      }
      quad[0].edge = quad[1].edge = static_cast<std::uint16_t>(3 * cell.offset + axis);
      quad[0].split = quad[1].split = splitBy(rank);
      for (const InterfaceQuad& side : quad) {
        if (side.label != 0 && isComplete) quads.push_back(side);
      }
    }
  }
  quads.shrink_to_fit();
  return quads;
}

}  // namespace sherd
