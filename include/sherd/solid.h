// The solid: a mesh as a narrow-band signed distance grid and its leaf blocks.
#pragma once

#include <sherd/coords.h>
#include <sherd/grid_fwd.h>
#include <sherd/leaf_blocks.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <cstdint>
#include <string>

namespace sherd {

/// How the inside of a mesh is found.
enum class Fill {
  automatic,  ///< winding, or shell if the mesh encloses no volume
  winding,    ///< generalized winding number >= 0.5: overlapping components unite, cavities stay,
              ///< holes are closed by a smooth surface that continues the mesh
  parity,     ///< a ray crosses the mesh an odd number of times, as in the paper: overlaps become
              ///< cavities; holes are closed by cones to the mesh's center
  flood,      ///< for closed meshes of any orientation: regions between surfaces are alternately
              ///< filled and empty, from the outside
  shell,      ///< a layer of shellThickness around the surface
};

/// Wall thickness of the solid, measured by inward rays from points on the mesh.  Near sharp edges
/// the thickness a little further inside is used.
struct WallThickness {
  double thinShare = 0.0;  ///< share of the area with a wall thinner than a voxel, 0..1
  double thinnest = 0.0;   ///< voxels; 99 % of the area has thicker walls
  int forWalls = 0;        ///< resolution that preserves walls of `thinnest`
  int forVolume = 0;       ///< resolution at which rounded edges and curves, such as of thin
                           ///< branches, lose a fiftieth of the volume
  int resolution = 0;      ///< the larger of both; 0 if this grid's resolution suffices
};

class Device;

/// Half width of every narrow band, in voxels.
inline constexpr int kHalfWidthVoxels = 3;

/// Components of the solid with fewer voxels are dropped and counted.
inline constexpr std::uint64_t kSmallComponentVoxels = 27;

/// Walls of at least this many voxels stay connected.
inline constexpr double kHeldWallVoxels = 1.25;

/// Walls of at least this many voxels keep their volume within about 2 %.
inline constexpr double kWholeWallVoxels = 1.5;

/// Selects the resolution that automaticResolution returns.
inline constexpr int kAutoResolution = 0;

/// Range of automatic resolutions.
inline constexpr int kLeastAutoResolution = 128, kMostAutoResolution = 512;

struct SolidOptions {
  int resolution = kAutoResolution;  ///< voxels along the mesh's longest side, 8..4096, or
                                     ///< kAutoResolution; used when voxelSize is 0
  double voxelSize = 0.0;            ///< world units per voxel; 0: from resolution
  Fill fill = Fill::automatic;
  double shellThickness = 0.0;  ///< world units, at most the mesh's longest side; 0: 2.5 voxels.
                                ///< For Fill::shell; with Fill::automatic, above 0 selects a shell
};

/// The resolution of a solid and its origin.
struct ResolutionChoice {
  int resolution = 0;      ///< voxels along the mesh's longest side; 0 for a volume's own voxels
  bool automatic = false;  ///< chosen by automaticResolution
};

/// Measurements and decisions of voxelize.
struct SolidReport {
  MeshDefects defects;
  Fill fill = Fill::winding;    ///< the fill used, never automatic
  std::string fillReason;       ///< why, as a clause of a sentence
  double shellThickness = 0.0;  ///< world units, of a shell; else 0
  double meshVolume = 0.0;      ///< of the mesh by the divergence theorem, with components oriented
                                ///< outwards and holes closed; 0 for a shell
  WallThickness walls{};
  ResolutionChoice resolution{};
  std::uint64_t bridges = 0;  ///< voxels added where those of a wall share only an edge or corner
};

/// A solid, read-only once returned.
struct Solid {
  GridFrame frame;
  ConstFloatGridPtr distance;  ///< level set, world units, inside negative, half width 3 voxels
  LeafBlocks blocks;           ///< inside and exterior-band voxels of `distance`
  VoxelBox box;                ///< tight box of the inside voxels
  std::uint64_t voxels = 0;    ///< inside voxels
  std::uint64_t smallComponents = 0;       ///< components dropped, see kSmallComponentVoxels
  std::uint64_t smallComponentVoxels = 0;  ///< voxels in them
  SolidReport report{};
};

/// Voxelizes a mesh.  First the mesh is repaired: duplicate triangles are dropped, triangles are
/// oriented consistently with their neighbors, and inside-out components are flipped, except inside
/// another component, where they bound cavities.  Then voxel centers are classified by
/// options.fill: exactly for closed meshes, with holes closed for open ones.  Distances are exact,
/// to the triangles that bound the solid.
///   throws  Error(input) box empty or not finite, no inside voxel at this resolution;
///           Error(usage) resolution, voxel size or thickness out of range; Error(cancelled)
///   source  Barill et al., Fast Winding Numbers for Soups and Clouds, 2018
[[nodiscard]] Solid voxelize(const TriangleMesh& mesh, const SolidOptions& options = {},
                             const Progress* progress = nullptr);

/// Returns the resolution that a mesh needs: the least multiple of eight, from kLeastAutoResolution
/// to kMostAutoResolution, at which 99 % of the area has walls of at least kWholeWallVoxels, and
/// rounded edges and curves lose at most a fiftieth of the volume (see WallThickness).  For shells
/// it is kLeastAutoResolution.
///
/// It depends only on the mesh and the fill, and does not change when the mesh is moved or scaled.
/// `resolution` and `voxelSize` of `options` are ignored.
///   throws  as voxelize
[[nodiscard]] int automaticResolution(const TriangleMesh& mesh, const SolidOptions& options = {});

/// Returns the voxel size that `options` specify for this mesh, in world units.
///   throws  Error(input) box empty or not finite; Error(usage) resolution, voxel size or thickness
///           out of range
[[nodiscard]] double voxelSizeFor(const TriangleMesh& mesh, const SolidOptions& options);

/// Returns the number of voxels of a size along the mesh's longest side, rounded up.
[[nodiscard]] int resolutionFor(const TriangleMesh& mesh, double voxelSize);

}  // namespace sherd
