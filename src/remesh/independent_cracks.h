// Moves the cracks' vertices of a fragment that is meshed independently of its neighbors.
#pragma once

#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <cstdint>

#include "remesh/complex.h"

namespace sherd {

/// Which fragment of which fracture: what is random depends on nothing else.
struct FragmentKey {
  std::uint64_t seed = 0;
  std::uint16_t fragment = 0;
};

/// Slides the vertices of cracks along the fragment's surface, to about where the mesh would have
/// them if its lattice were shifted by up to half a voxel along each axis, by another shift for
/// each fragment.  The two sides of a crack then sample it at different points: meshed on one
/// lattice, most of their vertices would be the same, which a network learns to look for.
///
/// A shift of the lattice itself would change which voxels are connected.  So faces and their
/// number stay, and with them a closed surface of one body:
/// - a vertex within a contact goes by the shift, to the nearest point of its faces;
/// - one on an edge of contacts goes along that edge, with the contact's faces on the left, so that
///   the two sides of a contact boundary go opposite ways;
/// - one where edges meet stays.
/// Each goes as far as none of its triangles rotates by more than 45 degrees or gets small.
///   mesh  closed, with neighbors; `other` is 0 on the original surface
void slideCracks(LabeledMesh& mesh, const GridFrame& frame, const FragmentKey& key);

/// Moves each vertex of the cracks' faces in a random direction by up to kCrackJitter, so that
/// corners, which cannot slide, are not the neighbor's to the bit.
///   mesh  with neighbors
void jitterCracks(TriangleMesh& mesh, const GridFrame& frame, const FragmentKey& key);

/// Voxels along each axis: no more than planes of merged triangles have.
inline constexpr double kCrackJitter = 0.005;

}  // namespace sherd
