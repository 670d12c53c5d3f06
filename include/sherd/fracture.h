// The whole way from a mesh to fragments.
#pragma once

#include <sherd/fragments.h>
#include <sherd/labels.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/seeds.h>
#include <sherd/solid.h>

#include <cstdint>
#include <string>
#include <vector>

namespace sherd {

struct FractureOptions {
  int pieces = 8;  ///< fragments wanted, 1..kMaxFragments
  std::uint64_t seed = 0;
  int resolution = 128;    ///< voxels along the longest side; used when voxelSize is 0
  double voxelSize = 0.0;  ///< world units per voxel; 0: from resolution
};

/// Seconds that one stage took.
struct StageTime {
  std::string stage;
  double seconds = 0.0;
};

struct FractureResult {
  Solid solid;
  std::size_t parts = 0;  ///< 6-connected parts of the solid
  Labels labels;
  std::vector<Fragment> fragments;  ///< [max(pieces, parts)] ascending by id
  std::vector<StageTime> times;
};

/// Break a mesh: voxelize, placeSeeds, grow, extractFragments, in this order and nothing else.
///   throws  what they throw
[[nodiscard]] FractureResult fracture(const TriangleMesh& mesh, const FractureOptions& options,
                                      Device& device, const Progress* progress = nullptr);

}  // namespace sherd
