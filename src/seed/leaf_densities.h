// Where pieces that come of splits are small.
#pragma once

#include <sherd/seeds.h>

#include <cstddef>
#include <vector>

namespace sherd {

/// Returns how many pieces there are meant to be per volume in each leaf, relative to others: by
/// SeedOptions::density, and near impacts.  With s the standard deviation of an impact's seeds
/// along the axis where it is largest, an impact at a distance of r adds 1 / (1 + (r / s)^2)^2 to a
/// twentieth, so that pieces there have up to a twentieth of the volume of those far away.
///   pieces  number of fragments
///   return  [leaves], or none where all are equal
///   throws  Error(usage) an impact misses, or has a value out of range
[[nodiscard]] std::vector<double> leafDensities(const Solid& solid,
                                                const VoxelComponents& components,
                                                const SeedOptions& options, std::size_t pieces);

}  // namespace sherd
