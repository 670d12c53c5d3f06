// The generalized winding number of any mesh at voxel centers.
#pragma once

#include <sherd/mesh.h>
#include <sherd/solid.h>
#include <tbb/concurrent_unordered_map.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "mesh/search/winding_in_ball.h"
#include "voxelize/fill/winding.h"
#include "voxelize/fill/work_limit.h"

namespace sherd {

/// The generalized winding numbers of a mesh at voxel centers: 1 inside a closed mesh, 0 outside,
/// in between near holes.
///
/// It is the winding number of the mesh closed by caps, an integer that Winding computes exactly,
/// minus that of the caps.  So a closed mesh needs no solid angles, and an open one only those of
/// its caps.
///   source  Jacobson, Kavan, Sorkine-Hornung, Robust Inside-Outside Segmentation using Generalized
///           Winding Numbers, 2013
class GeneralizedWinding {
 public:
  ///   mesh  in index space
  ///   caps  loopCaps(mesh)
  ///   tree  of the mesh
  ///   most  steps of work() for an open mesh
  ///   throws  Error(cancelled)
  GeneralizedWinding(const TriangleMesh& mesh, const TriangleMesh& caps,
                     std::shared_ptr<const TriangleTree> tree, const Progress* progress = nullptr,
                     std::uint64_t most = WorkLimit::kNone);
  ~GeneralizedWinding();

  [[nodiscard]] double at(const openvdb::Coord& voxel) const;
  [[nodiscard]] bool isInside(const openvdb::Coord& voxel) const { return near(voxel) >= 0.5; }

  /// Returns the winding number at any point, for a winding that is not isSimple(): that of the
  /// nearest voxel center, changed by each triangle in between.  The error is the smooth change
  /// over less than a voxel, which is small away from the boundaries of holes.
  [[nodiscard]] double near(const glm::dvec3& point) const;

  /// The same from some of the triangles.
  ///   around  at least all triangles within a voxel of the point, in tree()'s order
  [[nodiscard]] double near(const glm::dvec3& point, std::span<const std::uint32_t> around) const;

  /// The same from the voxel center nearest to `from`.
  [[nodiscard]] double near(const glm::dvec3& point, const glm::dvec3& from) const;

  /// Whether a winding number that near() returns for a point stays on its side of 0.5 within a
  /// voxel unless triangles change it.
  [[nodiscard]] bool isSteady(const glm::dvec3& point, double winding) const;

  /// Whether every surface in a box, and a voxel around it, separates the inside from the outside:
  /// the winding number of the closed mesh is 0 or 1 at the voxel centers there, and that of the
  /// caps is small.
  ///   box            of a triangle
  ///   samples, size  as for isFarFromHoles
  [[nodiscard]] bool isPlain(const Box& box, std::span<const glm::dvec3> samples,
                             double size) const;

  /// Whether the winding number of the caps is small on a whole triangle: it is small at the voxel
  /// centers nearest to the samples, and no boundary of a hole is near enough to change that
  /// between the samples.
  ///   samples  the triangle's center first, then points all over it
  ///   size     its longest edge, voxels
  [[nodiscard]] bool isFarFromHoles(std::span<const glm::dvec3> samples, double size) const;

  [[nodiscard]] const TriangleTree& tree() const { return *tree_; }

  /// The work of classifying points, in steps of about 10 ns: what is computed here is added,
  /// callers add theirs and check it.
  [[nodiscard]] WorkLimit& work() const { return work_; }

  /// Empty for a closed mesh.
  [[nodiscard]] const TriangleMesh& caps() const { return caps_; }

  /// Whether the mesh is closed and its winding number is 0 or 1 at all voxel centers: every
  /// surface then separates the inside from the outside.
  [[nodiscard]] bool isSimple() const {
    return caps_.triangles.empty() && columns_.lowest() >= 0 && columns_.highest() <= 1;
  }

 private:
  struct HashOf {
    std::size_t operator()(const openvdb::Coord& c) const { return c.hash<20>(); }
  };

  static constexpr int kOddSide = 4;
  void markOdd(const Progress* progress);
  // Returns the winding number of the caps at a voxel's center.
  [[nodiscard]] double capsAt(const openvdb::Coord& voxel) const;

  // Returns a number for which every comparison has the same result: computed faster, where the
  // bound of the error leaves none open.
  [[nodiscard]] double capsNear(const openvdb::Coord& voxel) const;

  // Returns the winding number, changed as capsNear().
  [[nodiscard]] double near(const openvdb::Coord& voxel) const {
    return columns_.at(voxel) - capsNear(voxel);
  }

  struct CapsInCube;
  [[nodiscard]] openvdb::Coord oddDims() const;

  glm::dvec3 tie_;
  TriangleMesh caps_;
  TriangleTree capTree_;
  TriangleTree boundaryTree_;  // of the caps' edges that bound the mesh
  Winding columns_;
  std::shared_ptr<const TriangleTree> tree_;
  mutable tbb::concurrent_unordered_map<openvdb::Coord, std::unique_ptr<CapsInCube>, HashOf> cubes_;
  mutable WorkLimit work_;
  std::vector<bool> odd_;  // cubes of kOddSide voxels that hold a winding number below 0 or above 1
};

}  // namespace sherd
