// Moves the cracks' vertices of a fragment that is meshed independently of its neighbors.
#pragma once

#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <cstdint>

#include "remesh/complex.h"
#include "remesh/resample/resample.h"

namespace sherd {

/// Moves each vertex of the cracks' faces in a random direction by up to kCrackJitter, so that
/// corners, which resampled() keeps, are not the neighbor's to the bit; less where triangles would
/// cross others.
///   mesh  with neighbors
void jitterCracks(TriangleMesh& mesh, const GridFrame& frame, const FragmentKey& key);

/// Voxels along each axis: no more than planes of merged triangles have.
inline constexpr double kCrackJitter = 0.005;

}  // namespace sherd
