// Labels, sheets and distances of cells.
#include "interface/cells/cell_values.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>

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

// Bits of the faces that are flipped, by the first corner of each label.
struct FlippedFaces {
  std::array<std::uint8_t, 8> faces{};
  bool dependsOnNeighbors = false;  // a face conflicts, so the neighbors' labels matter
};

FlippedFaces flippedByCorner(const Field& field, std::size_t leaf, const std::array<int, 3>& cell,
                             const CellLabels& labels) {
  FlippedFaces flipped;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::uint16_t label = labels[corner];
    const auto end = labels.begin() + static_cast<std::ptrdiff_t>(corner);
    if (label == 0 || std::find(labels.begin(), end, label) != end) continue;
    if (conflictingFaces(labels, label, 0) == 0) continue;
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

DistanceCube distancesOf(const Field& field, std::size_t leaf) {
  using Leaf = openvdb::FloatTree::LeafNodeType;
  DistanceCube cube;
  const auto grid = field.solid().distance->getConstAccessor();
  for (int k = 0; k < 8; ++k) {
    const std::array<int, 3> high{k >> 2, (k >> 1) & 1, k & 1};
    const openvdb::Coord low =
        field.solid().blocks->origins[leaf] + openvdb::Coord(8 * high[0], 8 * high[1], 8 * high[2]);
    const Leaf* const own = grid.probeConstLeaf(low);
    const float everywhere = own != nullptr ? 0.0f : grid.getValue(low);
    const auto count = [&](std::size_t axis) { return high[axis] != 0 ? 1 : 8; };
    for (int x = 0; x < count(0); ++x) {
      for (int y = 0; y < count(1); ++y) {
        float* const to = &cube[static_cast<std::size_t>(
            ((8 * high[0] + x) * 9 + 8 * high[1] + y) * 9 + 8 * high[2])];
        if (own == nullptr) {
          std::fill_n(to, count(2), everywhere);
        } else {
          std::copy_n(own->buffer().data() + x * 64 + y * 8, count(2), to);
        }
      }
    }
  }
  return cube;
}

std::array<float, 8> distancesAt(const DistanceCube& distance, const openvdb::Coord& cell) {
  std::array<float, 8> at;
  const auto low = static_cast<std::size_t>((cell.x() * 9 + cell.y()) * 9 + cell.z());
  for (std::size_t corner = 0; corner < 8; ++corner)
    at[corner] = distance[low + (corner >> 2) * 81 + ((corner >> 1) & 1) * 9 + (corner & 1)];
  return at;
}

CellValues valuesOf(const Field& field, const DistanceCube& distance, std::size_t leaf,
                    const openvdb::Coord& cell, const CellLabels& labels) {
  CellValues values;
  values.labels = labels;
  const bool isOnSurface = std::find(labels.begin(), labels.end(), 0) != labels.end();
  const std::uint16_t some = *std::max_element(labels.begin(), labels.end());
  const bool isCut =  // between two fragments
      std::any_of(labels.begin(), labels.end(), [&](auto l) { return l != 0 && l != some; });
  if (isOnSurface) values.toSurface = distancesAt(distance, cell);
  std::array<std::size_t, 8> voxelIndex{};
  for (unsigned c = 0; isCut && c < 8; ++c) {
    const openvdb::Coord at = cell + coordOfCorner(c);
    voxelIndex[c] = field.voxelIndexNear(leaf, at.x(), at.y(), at.z());
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
        input.on({cell + coordOfCorner(low), static_cast<std::uint8_t>(e / 4), labels[low] != 0});
  }
}

}  // namespace sherd
