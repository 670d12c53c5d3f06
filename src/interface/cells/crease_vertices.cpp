// Places vertices on creases.
#include "interface/cells/crease_vertices.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "interface/cells/cell_values.h"
#include "interface/cells/crease_point.h"
#include "interface/cells/quad_crossings.h"
#include "mesh/search/nearest_on_triangle.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

// A point nearer than this to the input is on it, up to rounding, in voxels.
constexpr double kOnSurface = 1e-3;

// Planes that meet farther from the input than this are of creases that the cell does not separate.
constexpr double kBeside = 0.05;

// Below this eigenvalue a crease is soft, and the position uncertain: a right angle has more, also
// where one of six crossings is on its other side.
constexpr double kClear = 0.12;

// The nearest points of the input: the planes of two creases less than a voxel apart meet beside
// it.
class OntoInput {
  static constexpr int kPasses = 8;

 public:
  ///   cell       its lowest corner
  ///   triangles  of the crossings: most points are on them
  OntoInput(const TriangleTree& input, const glm::dvec3& cell,
            std::span<const std::uint32_t> triangles)
      : input_(input), cell_(cell), triangles_(triangles) {}

  /// Returns a point of the input near one, within a box; both of the cell.
  [[nodiscard]] glm::dvec3 of(const glm::dvec3& p, const PositionBox& box) {
    if (p != from_) {
      from_ = p;
      nearest_ = nearestTo(cell_ + p);
    }
    if (!nearest_) return p;
    glm::dvec3 at = glm::clamp(*nearest_ - cell_, box.low, box.high);
    for (int pass = 1; pass < kPasses; ++pass) {  // the nearest point may be beyond the box
      const std::optional<glm::dvec3> on = nearestTo(cell_ + at);
      if (!on) break;
      at = glm::clamp(*on - cell_, box.low, box.high);
    }
    return at;
  }

 private:
  // Nothing if it is on the input, or far from it.
  [[nodiscard]] std::optional<glm::dvec3> nearestTo(const glm::dvec3& at) const {
    double reach = 2.0;  // voxels
    for (const std::uint32_t triangle : triangles_) {
      const double distance = std::sqrt(input_.squaredTo(at, triangle));
      if (distance < kOnSurface) return std::nullopt;
      reach = std::min(reach, 1.001 * distance);
    }
    const TriangleTree::Nearest nearest = input_.nearest(at, reach);
    if (nearest.triangle == TriangleTree::kNone || nearest.distance < kOnSurface)
      return std::nullopt;
    const std::array<glm::dvec3, 3> t = input_.corners(nearest.triangle);
    return nearestOnTriangle(at, t[0], t[1], t[2]);
  }

  const TriangleTree& input_;
  const glm::dvec3 cell_;
  const std::span<const std::uint32_t> triangles_;
  glm::dvec3 from_{INFINITY};
  std::optional<glm::dvec3> nearest_{};  // to it
};

std::optional<CreaseVertex> vertexOf(const TriangleTree& input, const glm::dvec3& cell,
                                     const CellValues& values, const CellSheets& sheets,
                                     unsigned position) {
  constexpr std::array<float, 2> kNoSnap{};
  const Crossings crossings = crossingsOf(values, sheets, position, kNoSnap);
  if (!crossings.areOnInput) return std::nullopt;
  const CreaseFit fit(TangentPlanes(crossings, true).span(), crossings.mean);
  std::array<std::uint32_t, 12> triangles;
  std::size_t count = 0;
  for (std::size_t e = 0; e < 12; ++e) {
    if (sheets.positionOf[e] == position) triangles[count++] = values.onInput[e]->triangle;
  }
  OntoInput ontoInput(input, cell, std::span(triangles).first(count));
  bool isForced = false;
  const auto placed = [&](const PositionBox& box) {
    CreasePoint point = fit.within(box);
    if (point.rank == 1) return point.at;
    const glm::dvec3 on = ontoInput.of(point.at, box);
    isForced = isForced || point.isClamped || point.least < kClear ||
               glm::distance(on, point.at) > kBeside;
    return on;
  };
  const glm::dvec3 at = placed(cellBox(-kMostOutside)), inCell = placed(cellBox(kCellMargin));
  return CreaseVertex{.edges = edgesOf(sheets, position),
                      .rank = static_cast<std::uint8_t>(fit.rank()),
                      .isForced = isForced,
                      .at = fit.rank() > 1 ? at : inCell,
                      .inCell = inCell};
}

// Adds the edges of a cell that the surface crosses, each once.
//   known  [9][9][9][axis] those that are there
void addCrossedEdges(const openvdb::Coord& cell, const CellLabels& labels,
                     std::bitset<9 * 9 * 9 * 3>& known, std::vector<CrossedEdge>& edges) {
  for (std::size_t e = 0; e < 12; ++e) {
    const unsigned low = kCellEdges[e][0], high = kCellEdges[e][1];
    if ((labels[low] == 0) == (labels[high] == 0)) continue;
    const CrossedEdge edge{cell + coordOfCorner(low), static_cast<std::uint8_t>(e / 4),
                           labels[low] != 0};
    const auto at = static_cast<std::size_t>(
        ((edge.low.x() * 9 + edge.low.y()) * 9 + edge.low.z()) * 3 + edge.axis);
    if (known[at]) continue;
    known[at] = true;
    edges.push_back(edge);
  }
}

// Returns the corner of a cell at which all crossed edges of a position end; 8 if there is none.
unsigned cornerOf(const CellSheets& sheets, unsigned position) {
  const std::uint16_t edges = edgesOf(sheets, position);
  for (unsigned corner = 0; corner < 8; ++corner) {
    unsigned ending = 0;
    for (unsigned e = 0; e < 12; ++e) {
      if (kCellEdges[e][0] == corner || kCellEdges[e][1] == corner) ending |= 1u << e;
    }
    if (edges == ending) return corner;
  }
  return 8;
}

// Whether a position is of a voxel whose six neighbors are all on the other side.  Its surface is a
// body of eight vertices, which lines of the input closer than a voxel could turn inside out, while
// those that the distances put on its edges surround it.
//   at  the cell's lowest corner in the leaf
bool isAroundLoneVoxel(const Field& field, std::size_t leaf, const openvdb::Coord& at,
                       const CellSheets& sheets, unsigned position) {
  const unsigned corner = cornerOf(sheets, position);
  if (corner == 8) return false;
  const openvdb::Coord voxel = at + coordOfCorner(corner);
  const auto isInside = [&](const openvdb::Coord& v) {
    return field.label(field.voxelIndexNear(leaf, v.x(), v.y(), v.z())) != 0;
  };
  const bool own = isInside(voxel);
  for (int axis = 0; axis < 3; ++axis) {
    for (const int step : {-1, 1}) {
      openvdb::Coord other = voxel;
      other[axis] += step;
      if (isInside(other) == own) return false;
    }
  }
  return true;
}

}  // namespace

LeafCreases creaseVertices(const Field& field, std::size_t leaf) {
  LeafCreases found;
  const openvdb::Coord& origin = field.solid().blocks->origins[leaf];
  InputCrossings input(field.solid(), origin);
  if (!input.exist()) return found;
  const LabelCube<9> corners = field.cornersOf(leaf);
  const PassedCells<9> passed = passedCells<9>(corners);
  if (std::none_of(passed.crossed.begin(), passed.crossed.end(), [](auto row) { return row != 0; }))
    return found;
  const DistanceCube distance = distancesOf(field, leaf);
  std::vector<std::uint16_t> cells;
  std::vector<CrossedEdge> edges;
  std::bitset<9 * 9 * 9 * 3> known;
  for (std::uint16_t offset = 0; offset < 512; ++offset) {
    const openvdb::Coord at = coordFromOffset(offset);
    const auto row = static_cast<std::size_t>(at.x() * 9 + at.y());
    if (((passed.crossed[row] >> at.z()) & 1) == 0) continue;
    if (!input.areNeededFor(distancesAt(distance, at))) continue;
    cells.push_back(offset);
    addCrossedEdges(at, labelsAt(corners, at), known, edges);
  }
  input.find(edges);
  for (const std::uint16_t offset : cells) {
    const openvdb::Coord at = coordFromOffset(offset), low = origin + at;
    const CellLabels labels = labelsAt(corners, at);
    CellValues values = valuesOf(field, distance, leaf, at, labels);
    const CellSheets* const plain = plainSheetsOf(labels);
    const CellSheets sheets =
        plain != nullptr ? *plain : resolvedSheets(field, leaf, at, labels).sheets;
    addInput(input, at, sheets, values);
    for (unsigned p = 0; p < sheets.positions; ++p) {
      if (isAroundLoneVoxel(field, leaf, at, sheets, p)) continue;
      const std::optional<CreaseVertex> vertex = vertexOf(
          *field.solid().region->boundary(), {low.x(), low.y(), low.z()}, values, sheets, p);
      if (!vertex) continue;
      found.vertices.push_back(*vertex);
      found.vertices.back().offset = offset;
    }
  }
  found.vertices.shrink_to_fit();
  found.crossings = input.found();
  return found;
}

}  // namespace sherd
