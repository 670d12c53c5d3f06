// Dual meshing of many labels.
#include "surface/interface_mesh.h"

#include <openvdb/openvdb.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "surface/cell.h"
#include "surface/cell_vertex.h"
#include "surface/rims.h"
#include "surface/touching.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = LeafBlocks::kNone;
constexpr std::uint16_t kNoCell = 0xffff;

// A cell that a surface passes through, by its lowest corner.
struct Cell {
  std::uint16_t offset = 0;
  CellSheets sheets;
  std::uint32_t firstLoop = 0;  // within the leaf
};

// The cells of a leaf, and their vertices.
struct LeafCells {
  std::vector<Cell> cells;
  std::array<std::uint16_t, 512> cellAt{};  // by offset; kNoCell where no surface passes
  std::vector<glm::dvec3> vertices;         // [loops] index space
  std::vector<std::uint32_t> places;        // [loops] equal where they share a position
  std::uint32_t placeCount = 0;
  std::vector<std::uint32_t> crowded;  // places where a fragment has several vertices
  std::vector<Junction> junctions;     // vertices within the leaf
  std::size_t firstVertex = 0;         // in the whole mesh
};

// Labels and distances by voxel, over leaf blocks.
class Field {
 public:
  Field(const Solid& solid, const Labels& labels, const Cut& cut)
      : solid_(solid), labels_(labels), cut_(cut), rounds_(leavesRound(solid.blocks.origins)) {}

  // The place of a voxel up to a leaf away from a leaf's own, x, y, z counted from its lowest; or
  // kNowhere.
  static constexpr std::size_t kNowhere = ~std::size_t{0};
  std::size_t placeNear(std::size_t leaf, int x, int y, int z) const {
    const auto k = static_cast<std::size_t>(((x >> 3) + 1) * 9 + ((y >> 3) + 1) * 3 + (z >> 3) + 1);
    const std::uint32_t other = rounds_[leaf][k];
    return other == kNone ? kNowhere : std::size_t{other} * 512 + offsetFromCoord({x, y, z});
  }

  std::uint16_t label(std::size_t place) const {
    return place != kNowhere && solid_.blocks.isInside(place) ? labels_.fragment[place]
                                                              : std::uint16_t{0};
  }

  CellLabels labelsOf(std::size_t leaf, int x, int y, int z) const {
    CellLabels labels;
    for (int corner = 0; corner < 8; ++corner) {
      labels[static_cast<std::size_t>(corner)] =
          label(placeNear(leaf, x + (corner >> 2), y + ((corner >> 1) & 1), z + (corner & 1)));
    }
    return labels;
  }

  // Voxels to the cut, negative inside the label's fragment.
  float toCut(std::size_t place, std::uint16_t label) const {
    if (place == kNowhere) return kHalfWidthVoxels;
    const std::size_t leaf = place / 512;
    if (cut_.index[leaf] == Cut::kWhole) {
      return cut_.only[leaf] == label ? -float{kHalfWidthVoxels} : float{kHalfWidthVoxels};
    }
    const CutLeaf& cells = cut_.leaves[cut_.index[leaf]];
    const auto at = std::lower_bound(cells.fragments.begin(), cells.fragments.end(), label);
    if (at == cells.fragments.end() || *at != label) return kHalfWidthVoxels;
    return cells
        .distance[static_cast<std::size_t>(at - cells.fragments.begin()) * 512 + place % 512];
  }

  const Solid& solid() const { return solid_; }
  const Cut& cut() const { return cut_; }

 private:
  const Solid& solid_;
  const Labels& labels_;
  const Cut& cut_;
  std::vector<LeafRound> rounds_;
};

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

std::array<std::uint8_t, 8> turnedByCorner(const Field& field, std::size_t leaf,
                                           const std::array<int, 3>& cell,
                                           const CellLabels& labels) {
  std::array<std::uint8_t, 8> turned{};
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::uint16_t label = labels[corner];
    if (label == 0 || doubledFaces(labels, label, 0) == 0) continue;
    turned[corner] = static_cast<std::uint8_t>(turnedFaces(field, leaf, cell, labels, label));
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
      if (labels[n] != 0) values.toCut[n][c] = field.toCut(place, labels[n]);
    }
  }
  return values;
}

// The labels of a leaf's voxels and of the layers beyond its high faces: all corners of its cells.
class CornerLabels {
 public:
  CornerLabels(const Field& field, std::size_t leaf) {
    std::size_t at = 0;
    for (int x = 0; x < kSide; ++x) {
      for (int y = 0; y < kSide; ++y) {
        for (int z = 0; z < kSide; ++z) labels_[at++] = field.label(field.placeNear(leaf, x, y, z));
      }
    }
  }

  bool isOne() const {
    return std::all_of(labels_.begin(), labels_.end(), [&](auto l) { return l == labels_[0]; });
  }

  CellLabels of(const openvdb::Coord& cell) const {
    const std::size_t low =
        static_cast<std::size_t>((cell.x() * kSide + cell.y()) * kSide + cell.z());
    CellLabels labels;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      labels[corner] =
          labels_[low + (corner >> 2) * kSide * kSide + ((corner >> 1) & 1) * kSide + (corner & 1)];
    }
    return labels;
  }

 private:
  static constexpr int kSide = 9;
  std::array<std::uint16_t, std::size_t{kSide} * kSide * kSide> labels_;
};

// Does a fragment have several sheets at one place of the cell?
bool isCrowded(const CellSheets& sheets, const CellLabels& labels, std::uint8_t position) {
  std::array<std::uint16_t, 24> labelOf{};  // of loops
  for (std::size_t e = 0; e < 12; ++e) {
    for (std::size_t side : {0, 1}) {
      const std::uint8_t loop = sheets.loopOf[e][side];
      if (loop != CellSheets::kNone) labelOf[loop] = labels[kCellEdges[e][side]];
    }
  }
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

LeafCells cellsOf(const Field& field, std::size_t leaf) {
  LeafCells found;
  found.cellAt.fill(kNoCell);
  const CornerLabels corners(field, leaf);
  if (corners.isOne()) return found;
  const openvdb::FloatGrid::ConstAccessor distance = field.solid().distance->getConstAccessor();
  const openvdb::Coord& origin = field.solid().blocks.origins[leaf];
  for (std::uint32_t offset = 0; offset < 512; ++offset) {
    const openvdb::Coord at = coordFromOffset(offset);
    const CellLabels labels = corners.of(at);
    if (std::all_of(labels.begin(), labels.end(), [&](auto l) { return l == labels[0]; })) continue;
    Cell cell;
    cell.offset = static_cast<std::uint16_t>(offset);
    cell.sheets = sheetsOf(labels, turnedByCorner(field, leaf, {at.x(), at.y(), at.z()}, labels));
    cell.firstLoop = static_cast<std::uint32_t>(found.vertices.size());
    const CellValues values = valuesOf(field, distance, leaf, at.x(), at.y(), at.z(), labels);
    const glm::dvec3 low(origin.x() + at.x(), origin.y() + at.y(), origin.z() + at.z());
    found.vertices.resize(found.vertices.size() + cell.sheets.loops);
    found.places.resize(found.vertices.size());
    for (std::uint8_t p = 0; p < cell.sheets.positions; ++p) {
      if (isCrowded(cell.sheets, labels, p)) found.crowded.push_back(found.placeCount + p);
      const CellVertex vertex = cellVertex(values, cell.sheets, p, field.cut().stairs);
      Junction junction{{}, low + vertex.wanted};
      for (std::uint8_t l = 0; l < cell.sheets.loops; ++l) {
        if (cell.sheets.positionOfLoop[l] != p) continue;
        junction.vertices.push_back(cell.firstLoop + l);
        found.vertices[cell.firstLoop + l] = low + vertex.at;
        found.places[cell.firstLoop + l] = found.placeCount + p;
      }
      if (vertex.wanted != vertex.at) found.junctions.push_back(std::move(junction));
    }
    found.placeCount += cell.sheets.positions;
    found.cellAt[offset] = static_cast<std::uint16_t>(found.cells.size());
    found.cells.push_back(cell);
  }
  return found;
}

// Corners bits of the axes.
constexpr std::array<unsigned, 3> kBit{4, 2, 1};

std::size_t edgeAlong(unsigned axis, unsigned corner) {
  for (std::size_t e = 4 * axis; e < 4 * axis + 4; ++e) {
    if (kCellEdges[e][0] == corner) return e;
  }
  return 12;
}

// The quads about the edges that begin at the lowest corner of the leaf's cells.
std::vector<InterfaceQuad> quadsOf(const Field& field, const std::vector<LeafCells>& all,
                                   std::size_t leaf) {
  std::vector<InterfaceQuad> quads;
  for (const Cell& cell : all[leaf].cells) {
    const openvdb::Coord at = coordFromOffset(cell.offset);
    for (unsigned axis = 0; axis < 3; ++axis) {
      if (cell.sheets.positionOf[edgeAlong(axis, 0)] == CellSheets::kNone) continue;
      openvdb::Coord beyond = at;
      ++beyond[static_cast<int>(axis)];
      const std::array<std::uint16_t, 2> label{
          field.label(field.placeNear(leaf, at.x(), at.y(), at.z())),
          field.label(field.placeNear(leaf, beyond.x(), beyond.y(), beyond.z()))};
      const unsigned b = (axis + 1) % 3, c = (axis + 2) % 3;
      // Round the edge as seen from its far end, counterclockwise.
      constexpr std::array<std::array<int, 2>, 4> kRing{{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
      std::array<std::array<std::uint32_t, 4>, 2> vertex{};
      for (std::size_t k = 0; k < 4; ++k) {
        openvdb::Coord low = at;
        low[static_cast<int>(b)] -= kRing[k][0];
        low[static_cast<int>(c)] -= kRing[k][1];
        const unsigned corner = (kRing[k][0] ? kBit[b] : 0) + (kRing[k][1] ? kBit[c] : 0);
        const std::size_t place = field.placeNear(leaf, low.x(), low.y(), low.z());
        const LeafCells& theirs = all[place / 512];
        const Cell& own = theirs.cells[theirs.cellAt[place % 512]];
        for (std::size_t side = 0; side < 2; ++side) {
          vertex[side][k] = static_cast<std::uint32_t>(theirs.firstVertex + own.firstLoop) +
                            own.sheets.loopOf[edgeAlong(axis, corner)][side];
        }
      }
      std::reverse(vertex[1].begin() + 1, vertex[1].end());  // the same diagonals
      for (std::size_t side = 0; side < 2; ++side) {
        if (label[side] != 0) quads.push_back({label[side], label[1 - side], vertex[side]});
      }
    }
  }
  return quads;
}

// The faces of one label.
struct LabelFaces {
  std::vector<InterfaceQuad> quads;
  std::vector<InterfaceTriangle> triangles;
};

// [fragments], in the order of leaves.
std::vector<LabelFaces> byLabel(const std::vector<std::vector<InterfaceQuad>>& ofLeaves,
                                const std::vector<InterfaceTriangle>& triangles, int fragments) {
  std::vector<LabelFaces> sorted(static_cast<std::size_t>(fragments));
  for (const std::vector<InterfaceQuad>& quads : ofLeaves) {
    for (const InterfaceQuad& quad : quads) {
      if (quad.label != Labels::kWorn) sorted[quad.label - 1u].quads.push_back(quad);
    }
  }
  for (const InterfaceTriangle& triangle : triangles) {
    sorted[triangle.label - 1u].triangles.push_back(triangle);
  }
  return sorted;
}

LabelledMesh meshOf(const LabelFaces& faces, const InterfaceVertices& vertices,
                    std::span<std::uint32_t> numbers) {
  LabelledMesh out;
  const auto number = [&](std::uint32_t vertex) {
    if (numbers[vertex] == kNone) {
      numbers[vertex] = static_cast<std::uint32_t>(out.mesh.vertices.size());
      out.mesh.vertices.push_back(vertices.at[vertex]);
      out.place.push_back(vertices.place[vertex]);
    }
    return numbers[vertex];
  };
  const auto add = [&](const std::array<std::uint32_t, 3>& t, std::uint16_t other) {
    out.mesh.triangles.emplace_back(number(t[0]), number(t[1]), number(t[2]));
    out.other.push_back(other);
  };
  for (const InterfaceQuad& quad : faces.quads) {
    for (const auto& t : trianglesOf(quad, vertices.at)) add(t, quad.other);
  }
  for (const InterfaceTriangle& triangle : faces.triangles) add(triangle.vertex, triangle.other);
  return out;
}

template <class Work>
void forEach(std::size_t count, const Work& work) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) work(i);
  });
}

}  // namespace

std::vector<LabelledMesh> interfaceMeshes(const Solid& solid, const Labels& labels, const Cut& cut,
                                          int fragments) {
  const Field field(solid, labels, cut);
  std::vector<LeafCells> cells(solid.blocks.count());
  forEach(cells.size(), [&](std::size_t leaf) { cells[leaf] = cellsOf(field, leaf); });
  InterfaceVertices vertices;
  std::vector<std::uint32_t> crowded;
  std::vector<Junction> junctions;
  for (LeafCells& leaf : cells) {
    leaf.firstVertex = vertices.at.size();
    for (const std::uint32_t p : leaf.places) vertices.place.push_back(vertices.places + p);
    for (const std::uint32_t p : leaf.crowded) crowded.push_back(vertices.places + p);
    vertices.places += leaf.placeCount;
    vertices.at.insert(vertices.at.end(), leaf.vertices.begin(), leaf.vertices.end());
    for (Junction& junction : leaf.junctions) {
      for (std::uint32_t& v : junction.vertices) v += static_cast<std::uint32_t>(leaf.firstVertex);
      junctions.push_back(std::move(junction));
    }
    leaf.vertices = {};
    leaf.places = {};
  }
  std::vector<std::vector<InterfaceQuad>> quads(cells.size());
  forEach(cells.size(), [&](std::size_t leaf) { quads[leaf] = quadsOf(field, cells, leaf); });
  straightenRims(quads, junctions, vertices.at);
  const std::vector<InterfaceTriangle> gaps = partTouchingSheets(crowded, quads, vertices);
  for (glm::dvec3& v : vertices.at) v = solid.frame.worldFromIndex({v}).v;
  const std::vector<LabelFaces> sorted = byLabel(quads, gaps, fragments);
  // A vertex belongs to one label, so fragments number theirs side by side.
  std::vector<std::uint32_t> numbers(vertices.at.size(), kNone);
  std::vector<LabelledMesh> meshes(sorted.size());
  forEach(meshes.size(), [&](std::size_t i) { meshes[i] = meshOf(sorted[i], vertices, numbers); });
  return meshes;
}

}  // namespace sherd
