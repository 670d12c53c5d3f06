// Erosion that is easy to believe: voxel by voxel, cell by cell.
#pragma once

#include <sherd/labels.h>

#include <functional>
#include <map>
#include <set>
#include <string>

#include "kernels/voxel_shapes.h"

namespace sherd::erode_reference {

/// A solid with a label on each inside voxel, both ways.
struct Labeled {
  std::string name;
  std::map<openvdb::Coord, int> voxels;
  Labels labels;  ///< label 1 is also on the outer band, which erosion must neither read nor change
};

Labeled labeled(const voxel_shapes::VoxelSolid& solid, int fragments,
                const std::function<int(const openvdb::Coord&)>& labelOf);

/// The solids that every shape is tried on; in some, voxels have no label.
std::vector<Labeled> all();

/// What erode() makes of each voxel's label where probability is 1.
std::map<openvdb::Coord, int> erode(const Labeled& solid, const ErodeOptions& options);

/// What tools::erodeActiveValues leaves of a fragment, by 6 or 26 neighbors.
std::set<openvdb::Coord> erodedByOpenVdb(const Labeled& solid, int fragment, bool by26);

}  // namespace sherd::erode_reference
