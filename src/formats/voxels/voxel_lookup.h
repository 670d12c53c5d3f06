// The label of any voxel of a run-length encoded box.
#pragma once

#include <sherd/files.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// Finds labels without expanding the box, of which only the number of runs takes memory.  Keeps a
/// reference to the voxels.
class VoxelLookup {
 public:
  ///   voxels  runs that fill the box
  explicit VoxelLookup(const RunLengthVoxels& voxels);

  /// Returns the label of a voxel; 0 beyond the box.
  [[nodiscard]] std::uint16_t at(const openvdb::Coord& voxel) const;

 private:
  const RunLengthVoxels& voxels_;
  std::vector<std::uint64_t> begins_;      // [runs + 1] first voxel of each run
  std::vector<std::uint64_t> firstRunIn_;  // [sections + 1] run of each section's first voxel
  unsigned sectionBits_ = 0;               // a section has 2^bits voxels
};

}  // namespace sherd
