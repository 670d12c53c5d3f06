// Meshes a fragment's surface by random points of its own.
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

/// Replaces the vertices of a mesh by random points of its surface, about as many, so that the
/// lattice of voxels by which it was meshed is not found in them, and so that two sides of a crack
/// have none in common but corners.  Points are added to the faces that are there, with edges to
/// their corners; then the vertices that were there collapse into them, one after the other, as far
/// as the surface stays near each.  Where it is curved as strongly as voxels resolve it, some are
/// left, and slide along it.  Then edges are flipped that make better triangles.  So the surface
/// stays closed and of one body.
///
/// Where the new mesh crosses itself, the faces there stay as they were.
///
/// Points along contact boundaries and creases are drawn on them, and their vertices collapse along
/// them.  Corners where these meet stay.
///   mesh    closed, edge- and vertex-manifold, with neighbors; `other` is 0 on the original
///   surface source  Turk, Re-tiling polygonal surfaces, 1992
[[nodiscard]] TriangleMesh resampled(const LabeledMesh& mesh, const GridFrame& frame,
                                     const FragmentKey& key);

/// Returns index space, rounded so that what is decided by positions does not depend on the frame.
[[nodiscard]] glm::dvec3 inVoxels(const GridFrame& frame, const glm::dvec3& world);

/// Voxels between points, at least, on faces and on features.
inline constexpr double kSampleDistance = 0.72;

/// How far a vertex of a contact boundary or a crease may be from the edge that replaces its two,
/// and any vertex from the triangles that replace those around it, voxels: most are nearer.
inline constexpr double kMostOffFeature = 0.1, kMostResampled = 0.2;

}  // namespace sherd
