// Winding numbers at many points of a small ball.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "mesh/search/triangle_tree.h"

namespace sherd {

/// The winding number of a tree's triangles in a ball, as TriangleTree::winding() computes it up to
/// a proved error: of the dipoles and triangles that it takes at every point of the ball, those far
/// away have a linear function, and only the others are computed for each point.
class TriangleTree::WindingInBall {
 public:
  ///   tree  not empty; must outlive this
  WindingInBall(const TriangleTree& tree, const glm::dvec3& center, double radius);

  /// Returns the winding number at a point of the ball.
  [[nodiscard]] double at(const glm::dvec3& point) const;

  /// Returns how many terms at() sums, dipoles at some points only as one.
  [[nodiscard]] std::size_t terms() const {
    return triangles_.size() + dipoles_.size() + mixed_.size() + 1;
  }

  /// A bound of the difference to TriangleTree::winding() at any point of the ball.
  [[nodiscard]] double error() const { return error_; }

 private:
  struct Mixed {
    std::uint32_t node, begin, end;
    int levelsBelow;
  };

  void addNode(const Range& range);
  void addTriangle(std::size_t triangle);
  [[nodiscard]] bool isLikeDipole(const Dipole& dipole);
  [[nodiscard]] bool isLinear(double secondDerivative);
  [[nodiscard]] bool isError(double angle);

  const TriangleTree* tree_;
  glm::dvec3 center_;
  double radius_;
  double angle_ = 0.0;        // of the linear function, steradians
  glm::dvec3 gradient_{0.0};  // of the linear function, with respect to the point
  double error_ = 0.0;
  std::vector<std::uint32_t> triangles_;
  std::vector<std::uint32_t> dipoles_;  // nodes
  std::vector<Mixed> mixed_;            // dipoles at some points only
};

}  // namespace sherd
