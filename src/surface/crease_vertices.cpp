// Places vertices on creases.
#include "surface/crease_vertices.h"

#include <openvdb/openvdb.h>

#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "mesh/nearest_on_triangle.h"
#include "surface/cell_values.h"
#include "surface/crease_point.h"
#include "surface/quad_crossings.h"
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

// The nearest point of the input within a box: the planes of two creases less than a voxel apart
// meet beside it.
glm::dvec3 ontoInput(const TriangleTree& input, const glm::dvec3& cell, const glm::dvec3& p,
                     const PositionBox& box) {
  constexpr double kReach = 2.0;  // voxels
  const TriangleTree::Nearest nearest = input.nearest(cell + p, kReach);
  if (nearest.triangle == TriangleTree::kNone || nearest.distance < kOnSurface) return p;
  const std::array<glm::dvec3, 3> t = input.corners(nearest.triangle);
  return glm::clamp(nearestOnTriangle(cell + p, t[0], t[1], t[2]) - cell, box.low, box.high);
}

std::optional<CreaseVertex> vertexOf(const TriangleTree& input, const glm::dvec3& cell,
                                     const CellValues& values, const CellSheets& sheets,
                                     unsigned position) {
  constexpr std::array<float, 2> kNoSnap{};
  const Crossings crossings = crossingsOf(values, sheets, position, kNoSnap);
  if (!crossings.areOnInput) return std::nullopt;
  const TangentPlanes planes(crossings, true);
  bool isForced = false;
  const auto placed = [&](const PositionBox& box) {
    CreasePoint point = creasePoint(planes.span(), crossings.mean, box);
    if (point.rank == 1) return point;
    const glm::dvec3 on = ontoInput(input, cell, point.at, box);
    isForced = isForced || point.isClamped || point.least < kClear ||
               glm::distance(on, point.at) > kBeside;
    point.at = on;
    return point;
  };
  const CreasePoint point = placed(cellBox(-kMostOutside)), inCell = placed(cellBox(kCellMargin));
  return CreaseVertex{.edges = edgesOf(sheets, position),
                      .rank = static_cast<std::uint8_t>(point.rank),
                      .isForced = isForced,
                      .at = point.rank > 1 ? point.at : inCell.at,
                      .inCell = inCell.at};
}

}  // namespace

std::vector<CreaseVertex> creaseVertices(const Field& field, std::size_t leaf) {
  std::vector<CreaseVertex> found;
  const openvdb::Coord& origin = field.solid().blocks->origins[leaf];
  InputCrossings input(field.solid(), origin);
  if (!input.exist()) return found;
  const LabelCube<9> corners = field.cornersOf(leaf);
  const PassedCells<9> passed = passedCells<9>(corners);
  const openvdb::FloatGrid::ConstAccessor distance = field.solid().distance->getConstAccessor();
  for (std::uint32_t offset = 0; offset < 512; ++offset) {
    const openvdb::Coord at = coordFromOffset(offset);
    const auto row = static_cast<std::size_t>(at.x() * 9 + at.y());
    if (((passed.crossed[row] >> at.z()) & 1) == 0) continue;
    const CellLabels labels = labelsAt(corners, at);
    CellValues values = valuesOf(field, distance, leaf, at, labels);
    if (!input.areNeededFor(values.toSurface)) continue;
    const CellSheets* const plain = plainSheetsOf(labels);
    const CellSheets sheets =
        plain != nullptr ? *plain : resolvedSheets(field, leaf, at, labels).sheets;
    addInput(input, at, sheets, values);
    const openvdb::Coord low = origin + at;
    for (unsigned p = 0; p < sheets.positions; ++p) {
      const std::optional<CreaseVertex> vertex = vertexOf(
          *field.solid().region->boundary(), {low.x(), low.y(), low.z()}, values, sheets, p);
      if (!vertex) continue;
      found.push_back(*vertex);
      found.back().offset = static_cast<std::uint16_t>(offset);
    }
  }
  return found;
}

}  // namespace sherd
