// Labels, sheets and distances of cells.
#include "surface/cell_values.h"

#include <algorithm>
#include <array>

namespace sherd {
namespace {

openvdb::Coord cornerOf(unsigned corner) {
  return {static_cast<int>(corner >> 2), static_cast<int>((corner >> 1) & 1),
          static_cast<int>(corner & 1)};
}

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

}  // namespace

CellLabels labelsAt(const LabelCube<9>& corners, const openvdb::Coord& cell) {
  CellLabels labels;
  const auto low = static_cast<std::size_t>((cell.x() * 9 + cell.y()) * 9 + cell.z());
  for (std::size_t corner = 0; corner < 8; ++corner) {
    labels[corner] = corners[low + (corner >> 2) * 81 + ((corner >> 1) & 1) * 9 + (corner & 1)];
  }
  return labels;
}

ResolvedSheets resolvedSheets(const Field& field, std::size_t leaf, const openvdb::Coord& cell,
                              const CellLabels& labels) {
  const auto flipped = flippedByCorner(field, leaf, {cell.x(), cell.y(), cell.z()}, labels);
  return {sheetsOf(labels, flipped.faces), flipped.dependsOnNeighbors};
}

CellValues valuesOf(const Field& field, const openvdb::FloatGrid::ConstAccessor& distance,
                    std::size_t leaf, const openvdb::Coord& cell, const CellLabels& labels) {
  CellValues values;
  values.labels = labels;
  const bool isOnSurface = std::find(labels.begin(), labels.end(), 0) != labels.end();
  const std::uint16_t some = *std::max_element(labels.begin(), labels.end());
  const bool isCut =  // between two fragments
      std::any_of(labels.begin(), labels.end(), [&](auto l) { return l != 0 && l != some; });
  const openvdb::Coord low = field.solid().blocks->origins[leaf] + cell;
  std::array<std::size_t, 8> voxelIndex{};
  for (int corner = 0; corner < 8; ++corner) {
    const openvdb::Coord step = cornerOf(static_cast<unsigned>(corner)), at = cell + step;
    const auto c = static_cast<std::size_t>(corner);
    if (isOnSurface) values.toSurface[c] = distance.getValue(low + step);
    if (isCut) voxelIndex[c] = field.voxelIndexNear(leaf, at.x(), at.y(), at.z());
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

void addInput(InputCrossings& input, const openvdb::Coord& cell, const CellSheets& sheets,
              CellValues& values) {
  if (!input.areNeededFor(values.toSurface)) return;
  const CellLabels& labels = values.labels;
  for (std::size_t e = 0; e < 12; ++e) {
    const unsigned low = kCellEdges[e][0], high = kCellEdges[e][1];
    if (sheets.positionOf[e] == CellSheets::kNone || (labels[low] != 0 && labels[high] != 0)) {
      continue;
    }
    values.onInput[e] =
        input.on(cell + cornerOf(low), static_cast<unsigned>(e / 4), labels[low] != 0);
  }
}

}  // namespace sherd
