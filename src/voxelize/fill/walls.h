// The wall thickness of a mesh, and the resolution that it needs.
#pragma once

#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "voxelize/fill/searched_mesh.h"

namespace sherd {

/// A point of a surface.
struct SurfaceSample {
  glm::dvec3 point, normal;
  glm::dvec3 tangent;  ///< unit vector along its triangle's first edge: it rotates with the mesh
};

/// Returns points on triangles, evenly distributed by area; none if the area is 0.
///   scattered  anywhere in the triangles; else at their centroids
[[nodiscard]] std::vector<SurfaceSample> surfaceSamples(const TriangleMesh& mesh, std::size_t count,
                                                        bool scattered);

/// Returns the thickness of the solid behind the mesh's surface.  Sheets thinner than a thousandth
/// of a voxel have no volume to lose and are ignored.
///   mesh                in index space, oriented outwards
///   longestSideVoxels   of the mesh's box
///   meshVolume          voxels
[[nodiscard]] WallThickness wallThickness(const SearchedMesh& mesh, double longestSideVoxels,
                                          double meshVolume);

/// Returns the automatic resolution that preserves such walls, a multiple of 8 within
/// kLeastAutoResolution..kMostAutoResolution.
[[nodiscard]] int automaticResolutionOf(const WallThickness& walls);

}  // namespace sherd
