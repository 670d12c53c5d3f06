// The solid: a mesh as a narrow-band signed distance grid, its leaf blocks, and its connected
// components.
#pragma once

#include <openvdb/math/Coord.h>
#include <openvdb/version.h>
#include <sherd/coords.h>
#include <sherd/device.h>
#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
using math::Coord;
namespace tree {
template <typename T, std::uint32_t Log2Dim>
class LeafNode;
template <typename ChildNode, std::uint32_t Log2Dim>
class InternalNode;
template <typename ChildNode>
class RootNode;
template <typename Root>
class Tree;
}  // namespace tree
template <typename Tree>
class Grid;
using FloatTree = tree::Tree<
    tree::RootNode<tree::InternalNode<tree::InternalNode<tree::LeafNode<float, 3>, 4>, 5>>>;
using FloatGrid = Grid<FloatTree>;
}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb

namespace sherd {

/// A grid, read-only once returned.
using ConstFloatGridPtr = std::shared_ptr<const openvdb::FloatGrid>;

/// The grid transform: the center of voxel (i,j,k) is origin + voxelSize * (i,j,k).
/// voxelize() puts `origin` at the lower corner of the mesh's box plus half a voxel.
struct GridFrame {
  WorldPoint origin{};     ///< of voxel (0,0,0)'s center
  double voxelSize = 1.0;  ///< world units per voxel, > 0

  IndexPoint indexFromWorld(const WorldPoint& p) const { return (p - origin) / voxelSize; }
  WorldPoint worldFromIndex(const IndexPoint& p) const { return origin + voxelSize * p; }
  WorldPoint worldFromIndex(const openvdb::Coord& voxel) const {
    return worldFromIndex(IndexPoint(voxel.x(), voxel.y(), voxel.z()));
  }
};

/// Voxels min..max, inclusive.
struct VoxelBox {
  openvdb::Coord min{0, 0, 0};
  openvdb::Coord max{-1, -1, -1};

  bool empty() const { return max.x() < min.x(); }
  openvdb::Coord dims() const { return max - min + openvdb::Coord(1, 1, 1); }
  int longestSide() const { return std::max({dims().x(), dims().y(), dims().z()}); }
};

/// Position of a voxel in its leaf from its offset 0..511.
inline openvdb::Coord coordFromOffset(std::uint32_t offset) {
  return {static_cast<int>(offset >> 6), static_cast<int>((offset >> 3) & 7),
          static_cast<int>(offset & 7)};
}

/// Offset 0..511 of a voxel in its leaf, from its index-space position.
inline std::uint32_t offsetFromCoord(const openvdb::Coord& voxel) {
  return static_cast<std::uint32_t>(((voxel.x() & 7) << 6) | ((voxel.y() & 7) << 3) |
                                    (voxel.z() & 7));
}

/// The leaves that hold inside voxels or exterior-band voxels, as flat arrays.
///
/// A voxel's offset in its leaf is OpenVDB's: (x << 6) | (y << 3) | z, z fastest.  A leaf's mask is
/// eight 64-bit words, word x holding the slab of that x, bit (y << 3) | z:
///
///     mask[leaf*8 + x]   bit 63 ............ 8  7 ............ 0
///                        y=7 z=7..0   ...       y=0 z=7..z=0
///
/// A voxel index is leaf * 512 + offset, ascending in leaf order.
///
/// The device reads the same arrays; kernels/leaf_block.h has the layout.
struct LeafBlocks {
  static constexpr std::uint32_t kNone = 0xffffffffu;  ///< in `neighbors`: no leaf

  std::vector<openvdb::Coord> origins{};  ///< [n] lowest voxel of each leaf, ascending by x, y, z
  std::vector<std::uint64_t> inside{};    ///< [n*8] voxels with distance < 0
  std::vector<std::uint64_t> exteriorBand{};  ///< [n*8] active voxels with distance >= 0
  std::vector<std::uint32_t> neighbors{};     ///< [n*6] leaf at -x +x -y +y -z +z, or kNone

  /// Inside voxels of bodies that come within three voxels or so of others: [layers - 1][n*8],
  /// those of layer 1 and on; all other inside voxels are of layer 0.  Voxels of different layers
  /// are not connected, even side by side.
  std::vector<std::vector<std::uint64_t>> layers{};

  std::size_t count() const { return origins.size(); }

  std::uint64_t insideVoxels() const {
    std::uint64_t n = 0;
    for (const std::uint64_t word : inside) n += static_cast<std::uint64_t>(std::popcount(word));
    return n;
  }

  bool isInside(std::size_t voxel) const { return (inside[voxel / 64] >> (voxel % 64)) & 1; }

  /// Layer of an inside voxel, see `layers`.
  std::size_t layerOf(std::size_t voxel) const {
    for (std::size_t i = 0; i < layers.size(); ++i) {
      if (layers[i][voxel / 64] >> (voxel % 64) & 1) return i + 1;
    }
    return 0;
  }

  /// Position of a voxel in the grid, from its index.
  openvdb::Coord voxelAt(std::size_t voxel) const {
    return origins[voxel / 512] + coordFromOffset(static_cast<std::uint32_t>(voxel % 512));
  }

  /// Calls visit(voxel) with the index of each inside voxel, ascending.
  template <class Visit>
  void forEachInside(const Visit& visit) const {
    for (std::size_t word = 0; word < inside.size(); ++word) {
      for (std::uint64_t bits = inside[word]; bits; bits &= bits - 1) {
        visit(word * 64 + static_cast<std::size_t>(std::countr_zero(bits)));
      }
    }
  }
};

/// How the inside of a mesh is found.
enum class Fill {
  automatic,  ///< winding, or shell if the mesh encloses no volume or takes too long to close
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

/// Half width of every narrow band, in voxels.
inline constexpr int kHalfWidthVoxels = 3;

/// Components of the solid with fewer voxels are dropped and counted, and those with a lower share
/// of them, as has a cube a hundredth as wide as another.
inline constexpr std::uint64_t kSmallComponentVoxels = 27;
inline constexpr double kSmallComponentShare = 1e-6;

/// Walls of at least this many voxels stay connected.
inline constexpr double kHeldWallVoxels = 1.25;

/// Walls of at least this many voxels keep their volume within about 2 %.
inline constexpr double kWholeWallVoxels = 1.5;

/// Selects the resolution that automaticResolution returns.
inline constexpr int kAutoResolution = 0;

/// Range of automatic resolutions.
inline constexpr int kLeastAutoResolution = 128, kMostAutoResolution = 512;

/// What bodies of a mesh are that overlap, touch or lie within others.
enum class MeetingBodies {
  unite,  ///< one body: their union
  keep,   ///< bodies of their own, each broken for itself.  A voxel in several belongs to that of
          ///< the least volume.  Of closed meshes that are filled by winding numbers
};

struct SolidOptions {
  int resolution = kAutoResolution;  ///< voxels along the mesh's longest side, 8..4096, or
                                     ///< kAutoResolution; used when voxelSize is 0
  double voxelSize = 0.0;            ///< world units per voxel; 0: from resolution
  Fill fill = Fill::automatic;
  double shellThickness = 0.0;  ///< world units, at most the mesh's longest side; 0: 2.5 voxels.
                                ///< For Fill::shell; with Fill::automatic, above 0 selects a
                                ///< shell; with Fill::winding, of sheets with both sides
  MeetingBodies bodies = MeetingBodies::unite;
  std::vector<std::uint32_t> objects{};  ///< [triangles] the object of each, or empty: with
                                         ///< MeetingBodies::keep closed objects are bodies of their
                                         ///< own where they share vertices
  bool keepMesh = false;                 ///< sets Solid::mesh, which Surface::exact needs
  bool keepSeams = true;                 ///< sets Solid::seams, along which meshes are cut
};

/// The resolution of a solid and its origin.
struct ResolutionChoice {
  int resolution = 0;      ///< voxels along the mesh's longest side; 0 for a volume's own voxels
  bool automatic = false;  ///< chosen by automaticResolution
};

/// Measurements and decisions of voxelize.
struct SolidReport {
  MeshDefects defects;
  Fill fill = Fill::winding;         ///< the fill used, never automatic
  std::string fillReason;            ///< why, as a clause of a sentence
  bool tookTooLong = false;          ///< a shell because winding numbers would take too long
  bool isThinnerThanVoxels = false;  ///< no voxel center lies inside the closed mesh: with
                                     ///< SolidOptions::keepMesh the voxels are a shell around it
  double shellThickness = 0.0;       ///< world units, of a shell; else 0
  double sheetThickness = 0.0;       ///< world units, of the shells that are made of sheets with
                                     ///< both sides beside what is filled otherwise; 0 if none are
  double meshVolume = 0.0;  ///< of the mesh by the divergence theorem, with components oriented
                            ///< outwards and holes closed; 0 for a shell
  WallThickness walls{};
  ResolutionChoice resolution{};
  std::uint64_t bridges = 0;  ///< voxels added where those of a wall share only an edge or corner
  std::uint64_t nearBodies = 0;  ///< bodies nearer than a voxel to others, which stay apart
  bool hasJoinedBodies = false;  ///< too many bodies are too near each other to stay apart
  std::uint64_t keptBodies = 0;  ///< with MeetingBodies::keep, of a mesh of several bodies; else 0
  bool lacksBodies = false;  ///< with MeetingBodies::keep, of a mesh that is open or not filled by
                             ///< winding numbers: its bodies are not known
  std::uint64_t hiddenBodies = 0;  ///< of these, without voxels of their own: they are left out
};

class Seams;
class SolidRegion;

/// The mesh that a solid was made from, repaired.
struct SolidMesh {
  TriangleMesh mesh;  ///< world units, with the vertices of the input, without attributes; oriented
                      ///< outwards where that is possible
  std::vector<std::uint32_t> source;   ///< [triangles] index in the input; TriangleMesh::kNoSource
                                       ///< of faces that close holes
  std::vector<std::uint16_t> layer{};  ///< [triangles] of their bodies, see LeafBlocks::layers;
                                       ///< empty: all in layer 0
  std::vector<std::uint32_t> body{};   ///< [triangles] with MeetingBodies::keep: the body of each,
                                       ///< numbered from 0 in the order of first triangles; empty:
                                       ///< bodies that overlap or touch are one
  std::vector<std::uint32_t> back{};   ///< [triangles] of the middle of a shell: index in the input
                                       ///< of the triangle behind, or the same; empty: the same
};

/// Holes of the input that Surface::exact closes by faces of their own.
struct ClosedHoles {
  std::size_t holes = 0;  ///< boundary loops
  std::size_t faces = 0;  ///< triangles that close them, before cracks cut these
  double area = 0.0;      ///< of the faces, world units
};

/// The mesh that Surface::exact has where it is not the input's: with its holes closed, and with
/// bodies that overlap, touch or cross themselves united.
struct UnitedBodies {
  std::size_t before = 0;                   ///< bodies of the input; 0 if none had to be united
  std::size_t after = 0;                    ///< bodies of the union
  ClosedHoles closed{};                     ///< of the input
  std::size_t loose = 0;                    ///< bodies that are left out: smaller than small
                                            ///< components, which the solid lacks
  std::shared_ptr<const SolidMesh> mesh{};  ///< null if it is the input's
};

/// A solid, read-only once returned.
struct Solid {
  GridFrame frame;
  /// Level set, world units, inside negative, half width 3 voxels.  Where voxels are under 1.44e-5
  /// units, OpenVDB refuses to copy its transform and to give its matrix.
  ConstFloatGridPtr distance;
  /// Inside and exterior-band voxels of `distance`; shared with the labels made from them.
  std::shared_ptr<const LeafBlocks> blocks;
  VoxelBox box;                            ///< tight box of the inside voxels
  std::uint64_t voxels = 0;                ///< inside voxels
  std::uint64_t smallComponents = 0;       ///< components dropped, see kSmallComponentVoxels
  std::uint64_t smallComponentVoxels = 0;  ///< voxels in them
  SolidReport report{};
  /// The mesh, which decides where seeds are inside, and on which splits and impacts are decided;
  /// null for a solid that has none.  It keeps trees of triangles, some 150 bytes for each, and
  /// their vertices once more.
  std::shared_ptr<const SolidRegion> region{};
  std::shared_ptr<const SolidMesh> mesh{};  ///< with SolidOptions::keepMesh, else null
  /// Where the surface attributes of the mesh change abruptly.  With SolidOptions::keepSeams, if
  /// they do so anywhere; else null.
  std::shared_ptr<const Seams> seams{};
  bool hasLinearAttributes = true;  ///< faces in one plane can be merged and keep the attributes of
                                    ///< the mesh; known with SolidOptions::keepSeams
};

/// Voxelizes a mesh.  First the mesh is repaired: duplicate triangles are dropped, triangles are
/// oriented consistently with their neighbors, and inside-out components are flipped, except inside
/// another component, where they bound cavities.  Then voxel centers are classified by
/// options.fill: exactly for closed meshes, with holes closed for open ones.  Distances are exact,
/// to the triangles that bound the solid.
///   throws  Error(input) the box's longest side is not in 1e-30..1e37, no inside voxel at this
///           resolution; Error(usage) resolution, voxel size or thickness out of range;
///           Error(cancelled)
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

/// Returns the voxels below which components of a solid are, or were, dropped.
[[nodiscard]] std::uint64_t leastComponentVoxels(const Solid& solid);

struct ApartLeaves;

/// The 6-connected components of the inside, numbered 0..count()-1 by their first voxel in leaf
/// order.  Voxels of different LeafBlocks::layers are not connected.
class VoxelComponents {
 public:
  std::size_t count() const { return voxels_.size(); }

  /// Returns the number of inside voxels of each component, [count()].
  const std::vector<std::uint64_t>& voxels() const { return voxels_; }

  /// Returns the component of an inside voxel.
  ///   voxel  index leaf * 512 + offset, see LeafBlocks
  std::uint32_t at(std::size_t voxel) const {
    const std::size_t leaf = voxel / 512;
    const std::uint32_t first = firstLocal_[leaf];
    const std::uint32_t local =
        first == kOneNode ? 0u : localNode_[std::size_t{first} * 512 + voxel % 512];
    return componentOfNode_[firstNode_[leaf] + local];
  }

 private:
  friend VoxelComponents findComponents(const LeafBlocks& blocks, Device& device);
  friend VoxelComponents joinedComponents(const VoxelComponents& found, const ApartLeaves& apart,
                                          const LeafBlocks& blocks);
  friend VoxelComponents apartComponents(const VoxelComponents& components,
                                         const ApartLeaves& apart);
  static constexpr std::uint32_t kOneNode = 0xffffffffu;

  // A node is a 6-connected component within one leaf.
  std::vector<std::uint32_t> firstNode_;   // [leaf] number of the leaf's first node
  std::vector<std::uint32_t> firstLocal_;  // [leaf] the leaf's block in localNode_; kOneNode for a
                                           // leaf with one node, as most are
  std::vector<std::uint16_t> localNode_;   // [..*512] node of an inside voxel within its leaf
  std::vector<std::uint32_t> componentOfNode_;  // [nodes]
  std::vector<std::uint64_t> voxels_;           // [count()]
};

/// Finds the 6-connected components on the device: a flood inside each leaf, then a union of the
/// nodes that touch across leaf faces.  The result does not depend on the schedule.
///   throws  Error(device)
///   source  Jaiganesh and Burtscher, ECL-CC, HPDC 2018 (the lock-free union)
[[nodiscard]] VoxelComponents findComponents(const LeafBlocks& blocks, Device& device);

}  // namespace sherd
