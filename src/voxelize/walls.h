// How thick the walls of a mesh are, and what resolution they need.
#pragma once

#include <sherd/mesh.h>

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "voxelize/fill.h"

namespace sherd {

/// A point of a surface.
struct SurfaceSample {
  glm::dvec3 point, normal;
  glm::dvec3
      along;  ///< unit vector in the surface that turns with the mesh: its triangle's first edge
};

/// Points of triangles, evenly by area; none where there is no area.
///   spread  anywhere in their triangles; else in the middle of them
[[nodiscard]] std::vector<SurfaceSample> surfaceSamples(const TriangleMesh& mesh, std::size_t count,
                                                        bool spread);

/// How thick the solid is behind the mesh's surface.  Sheets thinner than a thousandth of a voxel
/// have no volume to lose and are not looked at.
///   mesh                in index space, oriented outwards
///   longestSideVoxels   of the mesh's box
///   meshVolume          voxels
[[nodiscard]] WallThickness wallThickness(const SearchedMesh& mesh, double longestSideVoxels,
                                          double meshVolume);

/// The resolution that holds such walls, of those that are chosen automatically.
[[nodiscard]] int automaticResolutionOf(const WallThickness& walls);

}  // namespace sherd
