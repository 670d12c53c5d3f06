// Runs of voxels: building, checking, iterating by rows.
#include "formats/voxels/voxel_runs.h"

#include <sherd/error.h>

#include <cassert>
#include <limits>

#include "base/input_error.h"
#include "base/little_endian.h"

namespace sherd {
namespace {

constexpr std::uint64_t kLargestExpanded = std::uint64_t{1} << 31;

}  // namespace

openvdb::Coord boxOf(const std::array<std::uint64_t, 3>& sides, const std::string& name) {
  std::uint64_t voxels = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint64_t side = sides[axis];
    const bool fits = side > 0 && side <= std::numeric_limits<std::int32_t>::max() &&
                      voxels <= std::numeric_limits<std::uint64_t>::max() / side;
    if (!fits) {
      inputError(name, "its box has side " + std::to_string(side) + " along axis " + "xyz"[axis] +
                           "; does its content match its extension?");
    }
    voxels *= side;
  }
  return {static_cast<int>(sides[0]), static_cast<int>(sides[1]), static_cast<int>(sides[2])};
}

void appendNewRuns(std::vector<Run>& runs, std::uint16_t label, std::uint64_t length) {
  while (length > 0) {
    const std::uint64_t part = std::min(length, kLongestRun);
    runs.push_back({label, static_cast<std::uint32_t>(part)});
    length -= part;
  }
}

VoxelLabels expand(const RunLengthVoxels& voxels) {
  if (voxelsIn(voxels.dims) > kLargestExpanded) {
    throw Error(ErrorCode::input, "a box of " + std::to_string(voxelsIn(voxels.dims)) +
                                      " voxels is too large to expand; 2147483648 fit");
  }
  VoxelLabels dense{voxels.dims, {}};
  dense.labels.reserve(voxelsIn(voxels.dims));
  for (const Run& run : voxels.runs) {
    dense.labels.insert(dense.labels.end(), run.length, run.label);
  }
  assert(dense.labels.size() == voxelsIn(voxels.dims));
  return dense;
}

PlacedVoxels padded(const PlacedVoxels& from, Padding padding, const std::string& name) {
  const openvdb::Coord& dims = from.voxels.dims;
  const int side = std::max({dims.x(), dims.y(), dims.z()});
  const auto wide = static_cast<std::uint64_t>(side);
  if (wide * wide > kMostDenseVoxels / wide) {
    inputError(
        name, "a cube of " + std::to_string(side) + " voxels a side is too large to pad; 2580 fit");
  }
  openvdb::Coord start(0, 0, 0);
  if (padding == Padding::centered) {
    start = {(side - dims.x()) / 2, (side - dims.y()) / 2, (side - dims.z()) / 2};
  }
  PlacedVoxels cube{{{side, side, side}, {}}, from.transform};
  std::uint64_t done = 0;
  walkRows(from.voxels, [&](int x, int y, int z, int length, std::uint16_t label) {
    if (label == 0) return;
    const std::uint64_t at = (static_cast<std::uint64_t>(x + start.x()) * wide +
                              static_cast<std::uint64_t>(y + start.y())) *
                                 wide +
                             static_cast<std::uint64_t>(z + start.z());
    appendRun(cube.voxels.runs, 0, at - done);
    appendRun(cube.voxels.runs, label, static_cast<std::uint64_t>(length));
    done = at + static_cast<std::uint64_t>(length);
  });
  appendRun(cube.voxels.runs, 0, wide * wide * wide - done);
  if (cube.transform) {
    cube.transform->indexMin -= start;
    cube.transform->frame.origin =
        cube.transform->frame.worldFromIndex(openvdb::Coord(0, 0, 0) - start);
  }
  return cube;
}

Columns::Columns(const RunLengthVoxels& voxels) : ny_(static_cast<std::size_t>(voxels.dims.y())) {
  const std::size_t columns = static_cast<std::size_t>(voxels.dims.x()) * ny_;
  assert(columns <= kMost);
  first_.reserve(columns + 1);
  intervals_.reserve(columns + voxels.runs.size());
  walkRows(voxels, [&](int, int, int z, int length, std::uint16_t label) {
    if (z == 0) first_.push_back(intervals_.size());
    if (z > 0 && intervals_.back().label == label) {  // continues a run longer than 32 bits hold
      intervals_.back().end = z + length;
    } else {
      intervals_.push_back({label, z + length});
    }
  });
  first_.push_back(intervals_.size());
}

RunLengthVoxels withAxesReversed(const RunLengthVoxels& voxels, const std::string& name,
                                 MemoryBudget& memory) {
  const std::uint64_t total = voxelsIn(voxels.dims);
  if (total > kMostDenseVoxels) inputError(name, "has more than 2^34 voxels, too many to reorder");
  // In batches of voxels in the new order; the runs are walked once per batch.
  constexpr std::uint64_t kVoxelsAtATime = std::uint64_t{1} << 26;
  const openvdb::Coord& dims = voxels.dims;
  const std::uint64_t slice = total / static_cast<std::uint64_t>(dims.z());
  RunLengthVoxels reversed{{dims.z(), dims.y(), dims.x()}, {}};
  memory.charge(std::min(kVoxelsAtATime, total), sizeof(std::uint16_t));
  GrowingMemory growing(&memory);
  std::vector<std::uint16_t> dense;
  for (std::uint64_t begin = 0; begin < total; begin += kVoxelsAtATime) {
    const std::uint64_t end = std::min(begin + kVoxelsAtATime, total);
    dense.assign(end - begin, 0);
    walkRows(voxels, [&](int x, int y, int z, int length, std::uint16_t label) {
      if (label == 0) return;
      const std::uint64_t at =
          static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(dims.x()) +
          static_cast<std::uint64_t>(x);
      const auto slicesUpTo = [&](std::uint64_t index) {
        return index > at ? (index - at + slice - 1) / slice : 0;
      };
      const std::uint64_t last = std::min(static_cast<std::uint64_t>(z + length), slicesUpTo(end));
      for (std::uint64_t i = std::max(static_cast<std::uint64_t>(z), slicesUpTo(begin)); i < last;
           ++i) {
        dense[i * slice + at - begin] = label;
      }
    });
    for (std::size_t at = 0; at < dense.size(); ++at) {
      constexpr std::size_t kLabelsAtATime = std::size_t{1} << 16;
      if (at % kLabelsAtATime == 0)
        growing.hold((reversed.runs.size() + kLabelsAtATime) * sizeof(Run));
      appendRun(reversed.runs, dense[at], 1);
    }
  }
  return reversed;
}

void encodeDense(const RunLengthVoxels& voxels, const ByteSink& sink) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;  // bytes per call of the sink
  std::string block;
  for (const Run& run : voxels.runs) {
    for (std::uint32_t i = 0; i < run.length; ++i) {
      storeLittle(block, run.label);
      if (block.size() < kBlock) continue;
      sink(block);
      block.clear();
    }
  }
  sink(block);
}

}  // namespace sherd
