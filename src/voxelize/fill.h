// What a mesh bounds: a surface, and the side of it that voxel centres are on.
#pragma once

#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "mesh/triangle_tree.h"

namespace sherd {

/// A mesh, and what several steps ask of it.
struct SearchedMesh {
  TriangleMesh mesh;
  TriangleMesh caps;                         ///< loopCaps(mesh)
  std::shared_ptr<const TriangleTree> tree;  ///< of `mesh`
};
[[nodiscard]] SearchedMesh searched(TriangleMesh mesh);

/// A mesh that says what is inside.  All in index space.
struct Filling {
  Fill fill = Fill::winding;                    ///< not automatic
  std::string reason;                           ///< why, as half a sentence
  std::shared_ptr<const TriangleTree> surface;  ///< what the solid's distance is measured to

  std::function<bool(const openvdb::Coord&)> isInside;  ///< of a voxel's centre; empty for a shell

  double halfThickness = 0.0;  ///< voxels; of a shell: what is nearer to the surface is inside
};

/// How a mesh is to be filled.
struct FillChoice {
  Fill fill = Fill::winding;  ///< not automatic
  std::string reason;         ///< why, as half a sentence
};

/// The fill that `options` asks for, or the one that suits the mesh.
///   mesh  in any space
[[nodiscard]] FillChoice chosenFill(const SearchedMesh& mesh, const SolidOptions& options);

/// How thick a shell is, in voxels.
[[nodiscard]] double shellVoxels(const SolidOptions& options, double voxelSize);

/// The filling of a choice.
///   throws    Error(cancelled)
///   mesh      what repaired() gives, in index space
///   original  the same before repair, for a shell, which has doubled triangles too
[[nodiscard]] Filling fillingOf(const FillChoice& choice, const SearchedMesh& mesh,
                                const TriangleMesh& original, const SolidOptions& options,
                                double voxelSize, const Progress* progress = nullptr);

/// How well a mesh encloses what lies behind it: the mean over its area of the winding number just
/// behind the surface.  1 for closed meshes, 0.8 for half a ball, 0.5 for a flat sheet.
[[nodiscard]] double enclosure(const SearchedMesh& mesh);

}  // namespace sherd
