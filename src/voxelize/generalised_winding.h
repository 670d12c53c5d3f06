// The generalised winding number of any mesh at voxel centres.
#pragma once

#include <sherd/grid_fwd.h>
#include <sherd/mesh.h>
#include <tbb/concurrent_unordered_map.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "mesh/triangle_tree.h"
#include "voxelize/winding.h"

namespace sherd {

/// How much a mesh winds round voxel centres: 1 inside a closed one, 0 outside, in between near
/// holes.
///
/// It is that of the mesh closed by caps, a whole number which Winding tells exactly, less that of
/// the caps alone.  So a closed mesh costs no solid angle, and an open one those of its caps.
class GeneralisedWinding {
 public:
  ///   mesh  in index space
  ///   caps  loopCaps(mesh)
  ///   tree  of the mesh
  ///   throws  Error(cancelled)
  GeneralisedWinding(const TriangleMesh& mesh, const TriangleMesh& caps,
                     std::shared_ptr<const TriangleTree> tree, const Progress* progress = nullptr);

  [[nodiscard]] double at(const openvdb::Coord& voxel) const;
  [[nodiscard]] bool isInside(const openvdb::Coord& voxel) const { return at(voxel) >= 0.5; }

  /// At any point, where the winding is not simple: the nearest voxel centre's, changed by each
  /// triangle on the way.  Right but for what it changes otherwise over less than a voxel, which is
  /// little away from holes' rims.
  [[nodiscard]] double near(const glm::dvec3& point) const;

  /// The same, looking at some triangles only.
  ///   around  all triangles within a voxel of the point, in tree()'s order, or more
  [[nodiscard]] double near(const glm::dvec3& point, std::span<const std::uint32_t> around) const;

  /// The same, from the voxel centre that is nearest to another point.
  [[nodiscard]] double near(const glm::dvec3& point, const glm::dvec3& from) const;

  /// Whether a winding number near a point, such as near() has it, stays on its side of a half over
  /// a voxel unless triangles change it.
  [[nodiscard]] bool isSteady(const glm::dvec3& point, double winding) const;

  /// Whether every surface in a box, and a voxel round it, parts the inside from the outside: the
  /// closed mesh winds once or not at all round the voxel centres there, and its caps hardly.
  ///   box, looks, size  of a triangle, as isFarFromHoles has them
  [[nodiscard]] bool isPlain(const Box& box, std::span<const glm::dvec3> looks, double size) const;

  /// Whether the caps hardly wind round any point of a triangle: not round some of its points, or
  /// the voxels' centres next to them, and no hole's rim is so near that they may between these.
  ///   looks  the triangle's middle, and others all over it
  ///   size   its longest edge, voxels
  [[nodiscard]] bool isFarFromHoles(std::span<const glm::dvec3> looks, double size) const;

  [[nodiscard]] const TriangleTree& tree() const { return *tree_; }

  /// Empty for a closed mesh.
  [[nodiscard]] const TriangleMesh& caps() const { return caps_; }

  /// Whether the mesh is closed and no voxel centre lies in two of its bodies, or in one that is
  /// inside out: every surface then parts the inside from the outside.
  [[nodiscard]] bool isSimple() const {
    return caps_.triangles.empty() && columns_.lowest() >= 0 && columns_.highest() <= 1;
  }

 private:
  struct HashOf {
    std::size_t operator()(const openvdb::Coord& c) const { return c.hash<20>(); }
  };

  static constexpr int kOddSide = 4;
  void markOdd(const Progress* progress);
  // How the caps wind round a voxel's centre.
  [[nodiscard]] double capsAt(const openvdb::Coord& voxel) const;
  [[nodiscard]] openvdb::Coord oddDims() const;

  TriangleMesh caps_;
  TriangleTree capTree_;
  TriangleTree rimTree_;  // of the caps' edges that are the mesh's too
  Winding columns_;
  std::shared_ptr<const TriangleTree> tree_;
  mutable tbb::concurrent_unordered_map<openvdb::Coord, double, HashOf> knownCaps_;
  std::vector<bool> odd_;  // cubes of kOddSide voxels that hold a winding number below 0 or above 1
};

}  // namespace sherd
