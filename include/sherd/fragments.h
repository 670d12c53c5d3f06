// Fragments: what a piece is once it is cut out.
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

/// Where a fragment touches another.
struct Contact {
  int fragment = 0;        ///< id of the other
  double area = 0.0;       ///< world units squared, equal on both sides
  glm::dvec3 normal{0.0};  ///< mean direction towards the other, unit length
  WorldPoint centroid;     ///< of the shared surface, equal on both sides
};

/// One piece.  Volume, centroid, inertia and areas are those of its mesh.
struct Fragment {
  int id = 0;  ///< 1..n
  std::uint64_t voxels = 0;
  VoxelBox voxelBox;          ///< of its inside voxels
  ConstFloatGridPtr surface;  ///< level set, world units, transform and background as the solid's;
                              ///< null where it was not asked for
  TriangleMesh mesh;          ///< closed, edge-manifold, oriented outwards, world units
  std::vector<std::uint16_t>
      facing;  ///< [triangles] 0 original surface, else the fragment on the other side
  MassProperties mass;
  double area = 0.0;
  double fractureArea = 0.0;      ///< area of the faces that face another fragment
  std::vector<Contact> contacts;  ///< ascending by fragment
  std::vector<CoarseMesh>
      coarse{};  ///< `mesh` decimated, one for each of SurfaceOptions::triangles
};

/// The unbroken solid's surface, meshed once, of which fragments take over what does not change.
struct UnbrokenSurface;

/// Worth its time for a solid that is broken several times, with surfaces that are smooth and
/// shared.
[[nodiscard]] std::shared_ptr<const UnbrokenSurface> unbrokenSurface(const Solid& solid);

/// Cut every fragment out of the solid.  A fragment's level set is max(solid, distance to the cut);
/// the cut is the plane half way between two seeds where the labels are their Voronoi cells, and
/// elsewhere where the labels' indicators, smoothed by two binomial passes, are equal; so it is
/// smooth, two neighbours share it to the bit, and the original surface stays where it was.  Every
/// inside voxel's centre lies in its owner's level set, and in no other.
/// Meshes are made as options.interface says; the level sets are the same either way.
///   labels  of this solid's blocks, ids 1..fragments or Labels::kWorn, each id with at least one
///           voxel
///   unworn  the labels before erosion, when there was any: what worn faces faced, and what
///           touched, is read from them
///   surface how the mesh is made; the level set is the same for all
///   unbroken  of this solid, or null; the fragments are the same
///   return  [fragments] ascending by id
[[nodiscard]] std::vector<Fragment> extractFragments(const Solid& solid, const Labels& labels,
                                                     int fragments, const Labels* unworn = nullptr,
                                                     const SurfaceOptions& surface = {},
                                                     const Progress* progress = nullptr,
                                                     const UnbrokenSurface* unbroken = nullptr);

/// The curves that bound the faces of a fragment towards others, where their contacts end.
///   return  for each id that faces face: closed curves of the mesh's vertices, the faces on their
///           left seen from outside.  A curve may pass a vertex twice
[[nodiscard]] std::map<int, std::vector<std::vector<std::uint32_t>>> rimCurves(
    const Fragment& fragment);

/// The unbroken solid's smooth surface: that of its one fragment where it is not broken.
[[nodiscard]] TriangleMesh solidMesh(const Solid& solid);

}  // namespace sherd
