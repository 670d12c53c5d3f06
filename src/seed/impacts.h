// Impacts: where they strike, and the seeds that scatter about them.
#pragma once

#include <sherd/seeds.h>

#include <vector>

#include "seed/samplers.h"
#include "seed/voxel_index.h"

namespace sherd {

/// An impact with its place, number and width settled.
struct Blow {
  openvdb::Coord centre;   ///< a surface voxel
  std::uint32_t part = 0;  ///< of the centre
  std::size_t count = 0;
  glm::dvec3 side{0.0};  ///< an offset is side * the mean of so many uniforms about 0, voxels
  int terms = 0;
  bool merge = false;
};

/// Find where each impact strikes, the options' own first, then the random ones.
///   pieces  fragments that there will be
///   throws  Error(usage) a value out of range, a ray that misses
[[nodiscard]] std::vector<Blow> aim(const Solid& solid, const Parts& parts,
                                    const SeedOptions& options, std::size_t pieces,
                                    const VoxelIndex& inside, const VoxelIndex& surface);

/// Add a blow's seeds.
///   number  of the impact, 0 the first: each draws numbers of its own
///   inPart  [parts] candidates in each part
///   throws  Error(usage) fewer free voxels in the part
void scatter(const Blow& blow, std::size_t number, const VoxelIndex& candidates,
             const VoxelBox& box, const Parts& parts, std::span<const std::uint64_t> inPart,
             std::uint64_t seed, Chosen& chosen);

}  // namespace sherd
