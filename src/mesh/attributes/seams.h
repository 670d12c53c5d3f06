// Seams: where the surface attributes of a mesh change abruptly, and where a line beside the mesh
// passes them.
#pragma once

#include <sherd/coords.h>
#include <sherd/mesh.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "mesh/attributes/charts.h"
#include "mesh/search/triangle_tree.h"

namespace sherd {

/// The seams of a mesh: edges of charts, where material, texture coordinates or colors of two
/// triangles differ.  Charts of less area than a square voxel have none: their faces are no larger.
/// Points are in voxels, as given to the constructor.  Thread-safe.
///
/// Every answer depends on nothing but the points of the question, so that two fragments get the
/// same one for the edges that they share.
class Seams {
 public:
  /// Distances to seams are known up to this many voxels.
  static constexpr double kReach = 3.0;

  /// A line passes a seam that is at most this many voxels away.
  static constexpr double kAside = 0.75;

  /// A line passes no seam within so many voxels of its ends: they lie on the seam then.
  static constexpr double kOnSeam = 0.02;

  ///   mesh       with attributes
  ///   origin     of the points, world units
  ///   voxelSize  world units
  Seams(const TriangleMesh& mesh, const glm::dvec3& origin, double voxelSize);

  [[nodiscard]] bool empty() const { return edges_.empty(); }

  /// Returns whether faces in one plane can be merged on each side of the seams, and keep their
  /// attributes: not where these are other than linear in planes, or have charts without seams, on
  /// more than a hundredth of the area.
  [[nodiscard]] bool areLinear() const { return areLinear_; }

  /// Returns the distance to the nearest seam if it is below kReach, else infinity.
  [[nodiscard]] double distance(const IndexPoint& point) const {
    return edges_.nearest(point, kReach).distance;
  }

  /// Returns whether a seam is less than kReach from a ball.
  [[nodiscard]] bool isNear(const IndexPoint& center, double radius) const {
    return edges_.nearest(center, radius + kReach + 1e-6).triangle != TriangleTree::kNone;
  }

  /// Returns the chart at a point at most kReach from a seam; kNoTriangle for a small one.
  [[nodiscard]] std::uint32_t chartAt(const IndexPoint& point) const {
    return chart_[nearest(point).triangle];
  }

  /// Returns the same, but kNoTriangle for a chart that meets itself.
  [[nodiscard]] std::uint32_t sideAt(const IndexPoint& point) const {
    const std::uint32_t triangle = nearest(point).triangle;
    return meetsItself_[triangle] ? kNoTriangle : chart_[triangle];
  }

  /// Returns whether a line of this length may pass a seam that is so far from its ends.
  [[nodiscard]] static bool mayCross(double length, double fromBegin, double fromEnd) {
    return fromBegin + fromEnd <= length + 2.0 * kAside;
  }

  /// Returns where a line passes a seam, 0..1, if it does so more than kOnSeam from its ends: the
  /// triangles nearest to both sides of the place are not connected near the line.  Of several
  /// seams it is one.  None for a line along a seam.
  [[nodiscard]] std::optional<double> crossing(const IndexPoint& begin,
                                               const IndexPoint& end) const;

  /// Returns the nearest vertex where a seam turns or several meet, if one is within `reach`.
  [[nodiscard]] std::optional<IndexPoint> cornerNear(const IndexPoint& point, double reach) const;

  /// Returns the triangle of the mesh that is nearest to a point at most kReach from a seam.
  [[nodiscard]] std::uint32_t triangleAt(const IndexPoint& point) const {
    return source_[nearest(point).triangle];
  }

 private:
  // The triangle nearest to a point, in the order of the tree.
  struct Foot {
    std::uint32_t triangle = kNoTriangle;
    glm::dvec3 at{0.0};
  };
  struct Line;
  struct Side;

  static std::vector<double> chartAreas(const TriangleMesh& mesh, const Charts& charts);
  void takeTriangles(const TriangleMesh& mesh, const Charts& charts,
                     const std::vector<double>& areas);
  void takeCorners(const TriangleMesh& mesh, const std::vector<Charts::Seam>& seams);
  [[nodiscard]] Foot nearest(const IndexPoint& point) const;
  [[nodiscard]] std::uint32_t betterOf(const Foot& foot, const IndexPoint& point) const;
  [[nodiscard]] Side sideOf(const Foot& begin, const IndexPoint& middle, double reach) const;
  [[nodiscard]] std::optional<double> onEdge(const Line& line, double low, std::uint32_t lowIn,
                                             double high, std::uint32_t highIn) const;
  [[nodiscard]] double between(const Line& line, const Side& side, double low, std::uint32_t lowIn,
                               double high, std::uint32_t highIn) const;

  bool areLinear_ = true;
  TriangleTree edges_;    // of the seams, as triangles without area
  TriangleTree corners_;  // vertices of seams, as triangles without area
  TriangleTree near_;     // the triangles near seams

  // Of the triangles of near_, in its order.
  std::vector<std::uint32_t> source_;                    // index in the mesh
  std::vector<std::uint32_t> chart_;                     // kNoTriangle for a small one
  std::vector<bool> meetsItself_;                        // whether the chart does
  std::vector<std::array<std::uint32_t, 3>> connected_;  // as Charts::neighbors
  std::vector<std::array<std::uint32_t, 3>> beyond_;     // across a seam, or kNoTriangle
};

}  // namespace sherd
