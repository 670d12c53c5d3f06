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

/// How a mesh tells its inside.
enum class Fill {
  automatic,  ///< winding, or shell where the mesh encloses nothing
  winding,    ///< where the generalised winding number is a half or more: overlapping parts unite,
              ///< cavities stay, holes are closed by the smoothest surface that the mesh suggests
  parity,     ///< where a ray meets the mesh an odd number of times, as in the paper: overlaps
              ///< become holes; holes are closed by cones to the mesh's middle
  flood,      ///< regions between surfaces, filled and hollow by turns from the outside; of closed
              ///< meshes, whatever way their triangles are turned
  shell,      ///< all that is near the surface: a sheet of the shell's thickness
};

/// How thick the solid is, by rays from points on the mesh straight inwards.  Towards a sharp edge
/// a wall counts as thick as it is a little further in.
struct WallThickness {
  double thinShare = 0.0;  ///< 0..1 of the area behind which the wall is thinner than a voxel
  double thinnest = 0.0;   ///< voxels; all but a hundredth of the area has thicker walls
  int forWalls = 0;        ///< voxels along the longest side that hold a wall of `thinnest`
  int forVolume = 0;   ///< at which edges and curves cost a fiftieth of the volume, as they cost
                       ///< thin branches: their meshes are no finer than the voxels
  int resolution = 0;  ///< the larger of both; 0 where this grid has it
};

class Device;

/// Half width of every narrow band, in voxels.
inline constexpr int kHalfWidthVoxels = 3;

/// Parts of the solid with fewer voxels than this are specks: dropped and counted.
inline constexpr std::uint64_t kSpeckVoxels = 27;

/// Walls of this many voxels and more stay in one piece.
inline constexpr double kHeldWallVoxels = 1.25;

/// Walls of this many voxels and more keep their volume within some two hundredths.
inline constexpr double kWholeWallVoxels = 1.5;

/// In place of a resolution: the one that automaticResolution gives.
inline constexpr int kAutoResolution = 0;

/// The least and the highest resolution that is chosen automatically.
inline constexpr int kLeastAutoResolution = 128, kMostAutoResolution = 512;

struct SolidOptions {
  int resolution = kAutoResolution;  ///< voxels along the mesh's longest side, 8..4096, or
                                     ///< kAutoResolution; used when voxelSize is 0
  double voxelSize = 0.0;            ///< world units per voxel; 0: from resolution
  Fill fill = Fill::automatic;
  double shellThickness = 0.0;  ///< world units, of a shell, at most the mesh's longest side; 0:
                                ///< two and a half voxels.  With Fill::automatic, above 0 asks for
                                ///< a shell; other fills do not use it
};

/// Which resolution was used, and why.
struct ResolutionChoice {
  int resolution = 0;      ///< voxels along the mesh's longest side; 0 for a volume's own voxels
  bool automatic = false;  ///< chosen for the mesh, not given
};

/// What was found on the way from a mesh to its solid.
struct SolidReport {
  MeshDefects defects;
  Fill fill = Fill::winding;    ///< what was used; not automatic
  std::string fillReason;       ///< half a sentence
  double shellThickness = 0.0;  ///< world units, of a shell; else 0
  double meshVolume = 0.0;      ///< of the mesh by the divergence theorem, its parts turned
                                ///< outwards and its holes closed; 0 for a shell
  WallThickness walls{};
  ResolutionChoice resolution{};
  std::uint64_t bridges = 0;  ///< voxels added where a wall's own touch by edges or corners only
};

/// A solid, read-only once returned.
struct Solid {
  GridFrame frame;
  ConstFloatGridPtr distance;     ///< level set, world units, inside negative, half width 3 voxels
  LeafBlocks blocks;              ///< inside and outer-band voxels of `distance`
  VoxelBox box;                   ///< tight box of the inside voxels
  std::uint64_t voxels = 0;       ///< inside voxels
  std::uint64_t specks = 0;       ///< parts dropped for having fewer than kSpeckVoxels voxels
  std::uint64_t speckVoxels = 0;  ///< voxels in them
  SolidReport report{};
};

/// Turn a mesh into a solid.  Doubled triangles are dropped, triangles turned the way of their
/// neighbours, and parts that are inside out turned over, but for those within another part: these
/// bound cavities.  Then a voxel is inside where the mesh winds round its centre, or as
/// options.fill has it: of closed meshes exactly, so parts that overlap unite; holes of open ones
/// are closed.  Distances are exact, to the triangles that bound the solid.
///   throws  Error(input) box empty or not finite, nothing inside at this resolution;
///           Error(usage) resolution, voxel size or thickness out of range; Error(cancelled)
///   source  Barill et al., Fast Winding Numbers for Soups and Clouds, 2018
[[nodiscard]] Solid voxelize(const TriangleMesh& mesh, const SolidOptions& options = {},
                             const Progress* progress = nullptr);

/// The resolution that holds a mesh: the least multiple of eight, kLeastAutoResolution to
/// kMostAutoResolution, at which all but a hundredth of the surface has walls of
/// kWholeWallVoxels and more behind it, and at which edges and curves that are coarser than the
/// mesh cost at most a fiftieth of the volume (WallThickness).  Shells are as thick as they are
/// made: kLeastAutoResolution.
///
/// It depends on the mesh and the fill alone, not on memory, threads or device, and is the same for
/// a mesh that is moved or scaled.  resolution and voxelSize of `options` are not used.
///   throws  as voxelize
[[nodiscard]] int automaticResolution(const TriangleMesh& mesh, const SolidOptions& options = {});

/// The voxel size that `options` asks for on this mesh.
///   throws  Error(input) box empty or not finite; Error(usage) resolution, voxel size or thickness
///           out of range
[[nodiscard]] double voxelSizeFor(const TriangleMesh& mesh, const SolidOptions& options);

/// Voxels of a size along the mesh's longest side, a part of one counting as one.
[[nodiscard]] int resolutionFor(const TriangleMesh& mesh, double voxelSize);

}  // namespace sherd
