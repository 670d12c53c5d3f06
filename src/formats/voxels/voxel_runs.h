// Runs of voxels: building, checking, iterating by rows.
#pragma once

#include <sherd/files.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/memory_budget.h"

namespace sherd {

/// The largest box, in voxels, that is written or reordered voxel by voxel.
inline constexpr std::uint64_t kMostDenseVoxels = std::uint64_t{1} << 34;

inline constexpr std::uint64_t kLongestRun = std::numeric_limits<std::uint32_t>::max();

[[nodiscard]] inline std::uint64_t voxelsIn(const openvdb::Coord& dims) {
  return static_cast<std::uint64_t>(dims.x()) * static_cast<std::uint64_t>(dims.y()) *
         static_cast<std::uint64_t>(dims.z());
}

/// Returns the sides from a file as a box.
///   throws  Error(input) a side of 0, one that a Coord cannot hold, more voxels than 64 bits count
[[nodiscard]] openvdb::Coord boxOf(const std::array<std::uint64_t, 3>& sides,
                                   const std::string& name);

/// Appends runs, split where they are longer than 32 bits.
void appendNewRuns(std::vector<Run>& runs, std::uint16_t label, std::uint64_t length);

/// Extends the last run if the label is equal, else appends one; lengths beyond 32 bits are split.
inline void appendRun(std::vector<Run>& runs, std::uint16_t label, std::uint64_t length) {
  if (!runs.empty() && runs.back().label == label) {
    const std::uint64_t more = std::min<std::uint64_t>(length, kLongestRun - runs.back().length);
    runs.back().length += static_cast<std::uint32_t>(more);
    length -= more;
  }
  if (length > 0) appendNewRuns(runs, label, length);
}

/// Calls use(x, y, z, length, label) for each run, split at the ends of rows, in order.
template <class Use>
void walkRows(const RunLengthVoxels& voxels, Use use) {
  const std::uint64_t ny = static_cast<std::uint64_t>(voxels.dims.y());
  const std::uint64_t nz = static_cast<std::uint64_t>(voxels.dims.z());
  std::uint64_t x = 0, y = 0, z = 0;
  for (const Run& run : voxels.runs) {
    for (std::uint64_t left = run.length; left > 0;) {
      const std::uint64_t part = std::min(left, nz - z);
      use(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z), static_cast<int>(part),
          run.label);
      left -= part;
      z += part;
      if (z < nz) continue;
      z = 0;
      if (++y < ny) continue;
      y = 0;
      ++x;
    }
  }
}

/// The columns along z of a box, each a list of labeled intervals.
class Columns {
 public:
  struct Interval {
    std::uint16_t label = 0;
    std::int32_t end = 0;  ///< z after its last voxel
  };

  ///   voxels  at most 2^25 columns
  explicit Columns(const RunLengthVoxels& voxels);

  [[nodiscard]] std::size_t count(int x, int y) const {
    const std::size_t i = index(x, y);
    return first_[i + 1] - first_[i];
  }
  [[nodiscard]] const Interval* at(int x, int y) const { return &intervals_[first_[index(x, y)]]; }

  static constexpr std::uint64_t kMost = std::uint64_t{1} << 25;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(x) * ny_ + static_cast<std::size_t>(y);
  }

  std::size_t ny_;
  std::vector<Interval> intervals_;
  std::vector<std::size_t> first_;  ///< [columns + 1]
};

/// Returns the box with its axes in the opposite order: voxel (i, j, k) is voxel (k, j, i) of
/// `voxels`.
///   throws  Error(input) more than kMostDenseVoxels voxels, or more than `memory` allows
[[nodiscard]] RunLengthVoxels withAxesReversed(const RunLengthVoxels& voxels,
                                               const std::string& name, MemoryBudget& memory);

/// Writes every label, 2 bytes each, little-endian.
void encodeDense(const RunLengthVoxels& voxels, const ByteSink& sink);

}  // namespace sherd
