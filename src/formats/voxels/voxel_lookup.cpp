// The label of any voxel of a run-length encoded box.
#include "formats/voxels/voxel_lookup.h"

#include <algorithm>

#include "formats/voxels/voxel_runs.h"

namespace sherd {

VoxelLookup::VoxelLookup(const RunLengthVoxels& voxels) : voxels_(voxels) {
  // As many sections as runs, so that a section has few runs and the table is no larger.
  const std::uint64_t total = voxelsIn(voxels.dims), most = voxels.runs.size() + 1;
  while ((total >> sectionBits_) > most) ++sectionBits_;
  begins_.reserve(voxels.runs.size() + 1);
  firstRunIn_.reserve((total >> sectionBits_) + 2);
  std::uint64_t at = 0;
  for (std::size_t run = 0; run < voxels.runs.size(); ++run) {
    begins_.push_back(at);
    at += voxels.runs[run].length;
    while (firstRunIn_.size() << sectionBits_ < at) firstRunIn_.push_back(run);
  }
  begins_.push_back(at);
  firstRunIn_.push_back(voxels.runs.size() - 1);
}

std::uint16_t VoxelLookup::at(const openvdb::Coord& voxel) const {
  const openvdb::Coord& dims = voxels_.dims;
  std::uint64_t index = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (voxel[axis] < 0 || voxel[axis] >= dims[axis]) return 0;
    index =
        index * static_cast<std::uint64_t>(dims[axis]) + static_cast<std::uint64_t>(voxel[axis]);
  }
  const std::uint64_t section = index >> sectionBits_;
  const auto first = begins_.begin() + static_cast<std::ptrdiff_t>(firstRunIn_[section]);
  const auto end = begins_.begin() + static_cast<std::ptrdiff_t>(firstRunIn_[section + 1]) + 1;
  const auto run = std::upper_bound(first, end, index) - begins_.begin() - 1;
  return voxels_.runs[static_cast<std::size_t>(run)].label;
}

}  // namespace sherd
