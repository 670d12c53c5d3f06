// The solid that a mesh bounds: its surface, and which voxel centers are inside.
#pragma once

#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "mesh/search/triangle_tree.h"
#include "voxelize/fill/searched_mesh.h"

namespace sherd {

/// Depth of a layer at a surface, as a share of the longest side of the mesh's box: seeds of the
/// surface, and of a shell whose thickness is in voxels, lie in it.
inline constexpr double kSurfaceLayer = 1.0 / 256;

/// A mesh without its sheets that have both sides, and the middles of these.
struct SheetsApart {
  SearchedMesh rest;    ///< oriented outwards; may be empty
  TriangleMesh sheets;  ///< one triangle of each pair
};

/// A surface, and the classification of voxel centers as inside or outside.  All in index space.
struct Filling {
  Fill fill = Fill::winding;                    ///< not automatic
  std::string reason;                           ///< why this fill, as half a sentence
  std::shared_ptr<const TriangleTree> surface;  ///< the solid's distances are to this surface
  std::uint32_t firstClosing =
      TriangleTree::kNone;  ///< this and later triangles of its mesh close holes

  std::function<bool(const openvdb::Coord&)> isInside;  ///< of a voxel's center; empty for a shell
  std::function<bool(const glm::dvec3&)> contains;      ///< of any point; of a shell whose
                                                        ///< thickness is in voxels, a layer that
                                                        ///< every resolution has

  double halfThickness = 0.0;  ///< of a shell, voxels: points nearer to the surface are inside
};

/// The fill of a mesh, and the reason for it.
struct FillChoice {
  Fill fill = Fill::winding;  ///< not automatic
  std::string reason;         ///< why this fill, as half a sentence
  bool isLimited = false;     ///< given up where it takes too long:
  double workShare = 1.0;     ///< after this share of the usual limit
};

/// Returns the fill that `options` selects; the one that suits the mesh for Fill::automatic.
///   mesh  in any space
[[nodiscard]] FillChoice chosenFill(const SearchedMesh& mesh, const SolidOptions& options);

/// Returns the thickness of a shell in voxels.
[[nodiscard]] double shellVoxels(const SolidOptions& options, double voxelSize);

/// Returns the filling of a choice.
///   mesh      the result of repaired(), in index space, with shells of its sheets
///   original  the mesh before repair, used for a shell, which keeps duplicate triangles
///   apart     of a mesh with sheets, else null: points of a layer at these are inside, which does
///             not depend on the thickness of their shells
///   throws    Error(cancelled); TooMuchWork, if the choice is limited
[[nodiscard]] Filling fillingOf(const FillChoice& choice, const SearchedMesh& mesh,
                                const TriangleMesh& original, const SolidOptions& options,
                                double voxelSize, const Progress* progress = nullptr,
                                const SheetsApart* apart = nullptr);

/// Returns how completely a mesh encloses a volume: the mean over its area of the winding number
/// just behind the surface, which counts as 1 where it is above, and as 0 below.  1 for closed
/// meshes, 0.8 for half a ball, 0.5 for a flat sheet, and for sheets all over each other.
[[nodiscard]] double enclosure(const SearchedMesh& mesh);

}  // namespace sherd
