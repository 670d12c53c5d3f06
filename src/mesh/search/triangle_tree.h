// A tree of triangles for nearest distances, winding numbers and rays.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "mesh/search/nearest_on_triangle.h"
#include "mesh/search/solid_angles.h"

namespace sherd {

/// Triangles in a balanced binary tree of boxes.  Thread-safe.  A nearest distance does not depend
/// on how the tree was built: it is the least over all triangles, in double precision.
class TriangleTree {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  ///   mesh  may be empty; copied
  explicit TriangleTree(const TriangleMesh& mesh);

  /// Of a strip of long thin triangles, each beside the one before.  Their boxes hold most of space
  /// where they lie askew, and those that are near in space may lie in any direction: nodes are
  /// parts of the strip, and nearest() knows boxes along their mean normal and longest edge.
  [[nodiscard]] static TriangleTree ofStrip(const TriangleMesh& strip);

  [[nodiscard]] bool empty() const { return triangles_.empty(); }
  [[nodiscard]] std::size_t count() const { return triangles_.size(); }

  /// Returns the triangles in the tree's order, with their vertices.
  [[nodiscard]] TriangleMesh mesh() const { return {vertices_, triangles_}; }

  /// Returns the number of triangles.
  [[nodiscard]] std::size_t size() const { return triangles_.size(); }

  /// Returns the box of all triangles, rounded outwards to single precision; the tree must not be
  /// empty.
  [[nodiscard]] Box box() const { return {glm::dvec3(bounds_[0].min), glm::dvec3(bounds_[0].max)}; }

  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = kNone;  ///< in the tree's order: a guess for points nearby
  };

  /// Returns the nearest triangle that is less than `reach` away; an infinite distance if none is.
  ///   guess  a triangle that is likely near, from an earlier result
  [[nodiscard]] Nearest nearest(const glm::dvec3& point, double reach,
                                std::uint32_t guess = kNone) const;

  /// Returns the squared distance to a triangle, given by the tree's order.
  [[nodiscard]] double squaredTo(const glm::dvec3& point, std::size_t triangle) const {
    const std::array<glm::dvec3, 3> t = corners(triangle);
    const glm::dvec3 apart = point - nearestOnTriangle(point, t[0], t[1], t[2]);
    return glm::dot(apart, apart);
  }

  /// Returns the generalized winding number: the solid angle of all triangles at the point, divided
  /// by 4 pi.  A group of triangles more than 2.5 times its radius away counts as one dipole; the
  /// error is about 0.02.
  ///   source  Barill, Dickson, Schmidt, Levin, Jacobson: Fast Winding Numbers for Soups and
  ///           Clouds, 2018
  [[nodiscard]] double winding(const glm::dvec3& point) const;

  /// The same at many points of a small ball, with a bound of the difference: winding_in_ball.h.
  class WindingInBall;

  /// Returns the number of triangles that a short step enters through the front minus the number
  /// that it leaves through the back.  Of the triangles around an edge a step passes a consistent
  /// set.
  [[nodiscard]] int entries(const glm::dvec3& from, const glm::dvec3& to) const;

  /// The same for some triangles, given by the tree's order.
  [[nodiscard]] int entries(const glm::dvec3& from, const glm::dvec3& to,
                            std::span<const std::uint32_t> triangles) const;

  /// Returns the triangles whose boxes intersect a box, by the tree's order, ascending.
  [[nodiscard]] std::vector<std::uint32_t> meeting(const Box& box) const;

  /// The same, into a list that is reused.
  void findMeeting(const Box& box, std::vector<std::uint32_t>& found) const;

  /// Whether the box of a triangle intersects a box.
  [[nodiscard]] bool isAnyMeeting(const Box& box) const;

  /// Returns the corners of a triangle, given by the tree's order.
  [[nodiscard]] std::array<glm::dvec3, 3> corners(std::size_t triangle) const {
    const glm::uvec3& t = triangles_[triangle];
    return {vertices_[t.x], vertices_[t.y], vertices_[t.z]};
  }

  /// Returns the index in the mesh of a triangle, given by the tree's order.
  [[nodiscard]] std::uint32_t source(std::size_t triangle) const { return source_[triangle]; }

  /// Returns the distance of a ray's first hit beyond `from`, in lengths of `direction`; infinite
  /// if it hits nothing.
  [[nodiscard]] double firstHit(const glm::dvec3& origin, const glm::dvec3& direction,
                                double from) const;

  struct Hit {
    double at = 0.0;             ///< 0 at the segment's begin, 1 at its end
    std::uint32_t triangle = 0;  ///< in the tree's order
  };

  /// Returns where a segment first meets a triangle, of several the first in the mesh.  Edges
  /// belong to their triangles, so that no segment passes between two of them.
  [[nodiscard]] std::optional<Hit> firstBetween(const glm::dvec3& from, const glm::dvec3& to) const;

  /// The same for some triangles, given by the tree's order.
  [[nodiscard]] std::optional<Hit> firstBetween(const glm::dvec3& from, const glm::dvec3& to,
                                                std::span<const std::uint32_t> triangles) const;

 private:
  // A traversal stores one node per level; 2^32 triangles have 30 levels.
  static constexpr std::size_t kDeepest = 64;

  // Groups farther away than this many of their radii count as dipoles.
  static constexpr double kFarRadii = 2.5;

  struct Bounds {
    glm::vec4 min, max;  // rounded outwards; w is 0, for reading four at a time
  };
  struct Dipole {
    glm::dvec3 center{0.0};  // of the triangles, weighted by area
    glm::dvec3 normal{0.0};  // sum of area * normal
    double area = 0.0;
    double radius = 0.0;  // of all triangles, around `center`
  };

  // The points whose dot products with three axes are within bounds, rounded outwards.
  struct OrientedBox {
    std::array<glm::dvec3, 3> axis{};  // unit and orthogonal, or 0
    glm::dvec3 least{0.0}, most{0.0};

    // Returns the squared distance of a point, or less.
    [[nodiscard]] double squaredTo(const glm::dvec3& point, double slack) const;
  };

  // A node of the tree, which is complete: its children are 2 node + 1 and 2 node + 2.
  struct Range {
    std::size_t node, begin, end;
    int levelsBelow;
    [[nodiscard]] bool isLeaf() const { return levelsBelow == 0; }
    [[nodiscard]] Range child(int which) const {
      const std::size_t middle = begin + (end - begin) / 2;
      return which == 0 ? Range{2 * node + 1, begin, middle, levelsBelow - 1}
                        : Range{2 * node + 2, middle, end, levelsBelow - 1};
    }
  };
  [[nodiscard]] Range root() const { return {0, 0, triangles_.size(), levels_}; }
  [[nodiscard]] std::size_t firstLeaf() const { return (std::size_t{1} << levels_) - 1; }

  struct Item {
    glm::vec3 center;  // the sum of the corners: three times the centroid
    std::uint32_t triangle;
  };

  // Visits the triangles of all leaves, except below nodes for which `skip` returns true.
  template <class Skip, class Visit>
  void walk(const Skip& skip, const Visit& visit) const {
    if (!empty()) walk(root(), skip, visit);
  }

  // The same of the triangles below a node.
  template <class Skip, class Visit>
  void walk(const Range& from, const Skip& skip, const Visit& visit) const {
    std::array<Range, kDeepest> stack;
    std::size_t waiting = 0;
    stack[waiting++] = from;
    while (waiting > 0) {
      const Range range = stack[--waiting];
      if (skip(range)) continue;
      if (!range.isLeaf()) {
        stack[waiting++] = range.child(1);
        stack[waiting++] = range.child(0);
        continue;
      }
      for (std::size_t i = range.begin; i < range.end; ++i) visit(i);
    }
  }

  // Adds the triangles near a point of those below a node to `near`.  Returns the solid angle of
  // the others, as dipoles.
  double addSolidAngles(const Range& range, const glm::dvec3& point, SolidAngles& near) const;

  // `squaredTo` returns a lower bound of a point's squared distance to a node's triangles.
  template <class SquaredTo>
  [[nodiscard]] Nearest nearestBy(const SquaredTo& squaredTo, const glm::dvec3& point, double reach,
                                  std::uint32_t guess) const;

  TriangleTree(const TriangleMesh& mesh, bool isSorted);
  static void sortInto(std::span<Item> items, const Range& range);
  void measure(const Range& range);
  void addOrientedBoxes();
  [[nodiscard]] OrientedBox orientedBox(const Range& range) const;
  [[nodiscard]] static std::optional<Hit> clamped(const Hit& hit);
  void hit(const glm::dvec3& from, const glm::dvec3& along, std::size_t triangle, Hit& first) const;
  [[nodiscard]] int entry(const glm::dvec3& from, const glm::dvec3& to, std::size_t triangle) const;

  std::vector<glm::dvec3> vertices_;
  std::vector<glm::uvec3> triangles_;  // in the order of the leaves
  std::vector<std::uint32_t> source_;  // [triangles] index in the mesh
  std::vector<std::uint32_t> first_;   // [leaves + 1] a leaf's first triangle
  std::vector<Bounds> bounds_;         // [nodes]
  std::vector<Dipole> dipoles_;        // [nodes]
  std::vector<OrientedBox> oriented_;  // [nodes] of a strip, else empty
  int levels_ = 0;                     // below the root
};

}  // namespace sherd
