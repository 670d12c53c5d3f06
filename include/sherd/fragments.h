// Fragments: level set, mesh, mass properties and contacts.
#pragma once

#include <sherd/coords.h>
#include <sherd/grid_fwd.h>
#include <sherd/labels.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>
#include <sherd/solid.h>
#include <sherd/surface.h>

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace sherd {

/// The contact of a fragment with another one.
struct Contact {
  int fragment = 0;        ///< id of the other fragment
  double area = 0.0;       ///< world units squared, equal on both sides
  glm::dvec3 normal{0.0};  ///< mean direction towards the other fragment, unit length
  WorldPoint centroid;     ///< of the shared surface, equal on both sides
};

/// One fragment.  Volume, centroid, inertia and areas are computed from its mesh.
struct Fragment {
  int id = 0;  ///< 1..n
  std::uint64_t voxels = 0;
  VoxelBox voxelBox;          ///< of its inside voxels
  ConstFloatGridPtr surface;  ///< level set, world units, transform and background of the solid;
                              ///< null without SurfaceOptions::levelSets
  TriangleMesh mesh;  ///< closed, edge-manifold, oriented outwards, world units, with neighbors
  MassProperties mass;
  double area = 0.0;
  double fractureArea = 0.0;      ///< area of the triangles with neighbor > 0
  std::vector<Contact> contacts;  ///< ascending by fragment
  std::vector<TriangleMesh>
      coarse{};  ///< [SurfaceOptions::triangles] decimated meshes, with neighbors
};

/// The mesh of the intact solid's surface, from which fragments copy what the cuts do not change.
struct IntactSurface;

/// Meshes the intact solid.  Saves time if a solid is broken several times with Surface::smooth and
/// Interface::shared.
[[nodiscard]] std::shared_ptr<const IntactSurface> intactSurface(const Solid& solid);

struct ExtractOptions {
  SurfaceOptions surface{};          ///< how meshes are made; level sets do not depend on it
  const Labels* uneroded = nullptr;  ///< the labels before erosion, or null without erosion;
                                     ///< neighbors of eroded faces and contacts are computed from
                                     ///< them
  const IntactSurface* intact = nullptr;  ///< of this solid, or null; affects only the speed
};

/// Cuts every fragment out of the solid.  A fragment's level set is max(solid, distance to the
/// cut). Where labels are the Voronoi cells of two seeds, the cut is the plane half way between
/// them; elsewhere it is where the labels' indicators, smoothed by two binomial passes, are equal.
/// So the cut is smooth, neighbors share it bit for bit, and the original surface does not move.
/// Every inside voxel's center lies in its owner's level set and in no other.
///   labels    of this solid's blocks: ids 1..fragments, each with at least one voxel, or
///             Labels::kEroded
///   return    [fragments] ascending by id
[[nodiscard]] std::vector<Fragment> extractFragments(const Solid& solid, const Labels& labels,
                                                     int fragments,
                                                     const ExtractOptions& options = {},
                                                     const Progress* progress = nullptr);

/// Returns the boundary loops of a fragment's contacts.
///   return  for each neighbor id: closed loops of indices of the mesh's vertices, with the
///           contact's faces on the left seen from outside.  A loop may visit a vertex twice
[[nodiscard]] std::map<int, std::vector<std::vector<std::uint32_t>>> boundaryLoops(
    const Fragment& fragment);

/// Returns the smooth mesh of the intact solid, equal to that of a fracture into one fragment.
[[nodiscard]] TriangleMesh solidMesh(const Solid& solid);

}  // namespace sherd
