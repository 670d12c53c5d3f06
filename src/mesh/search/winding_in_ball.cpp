// Winding numbers at many points of a small ball.
//
// winding() sums n r / |r|^3 over dipoles, and over the area of triangles near the point.  This is
// the first derivative of the harmonic function -1 / |r|, so its derivatives of order k are at most
// (k + 1)! |n| / |r|^(k + 2).  That bounds the error of a linear function, and of a dipole in place
// of others near it.
#include "mesh/search/winding_in_ball.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "mesh/search/nearest_on_triangle.h"
#include "mesh/search/solid_angles.h"

namespace sherd {
namespace {

constexpr double kSphere = 4.0 * std::numbers::pi;

// Errors as shares of the sphere: of one term, and of all.
constexpr double kLargestError = 3e-3, kLargestSum = 0.1;

// Exceeds the difference of sums in another order.
constexpr double kRoundings = 1e-8;

// Returns the gradient of a triangle's solid angle with respect to the point: the field of a
// current along its edges, by the law of Biot and Savart.
glm::dvec3 gradientOf(const std::array<glm::dvec3, 3>& t, const glm::dvec3& point) {
  glm::dvec3 sum(0.0);
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 a = t[k] - point, b = t[(k + 1) % 3] - point;
    const double la = glm::length(a), lb = glm::length(b);
    sum += (la + lb) / (la * lb * (la * lb + glm::dot(a, b))) * glm::cross(a, b);
  }
  return sum;
}

}  // namespace

TriangleTree::WindingInBall::WindingInBall(const TriangleTree& tree, const glm::dvec3& center,
                                           double radius)
    : tree_(&tree), center_(center), radius_(radius), error_(kRoundings) {
  tree.walk(
      [&](const Range& range) {
        const Dipole& dipole = tree.dipoles_[range.node];
        const double distance = glm::length(dipole.center - center);
        const double far = kFarRadii * dipole.radius, slack = radius * (1.0 + kRoundings);
        if (distance + slack < far) return false;  // nowhere a dipole
        if (distance - slack > far || isLikeDipole(dipole)) {
          addNode(range);
        } else {
          mixed_.push_back({static_cast<std::uint32_t>(range.node),
                            static_cast<std::uint32_t>(range.begin),
                            static_cast<std::uint32_t>(range.end), range.levelsBelow});
        }
        return true;
      },
      [&](std::size_t triangle) { addTriangle(triangle); });
  triangles_.shrink_to_fit();
  dipoles_.shrink_to_fit();
  mixed_.shrink_to_fit();
}

// Whether a node's dipole may stand for its triangles, and for all dipoles of some of them: each of
// these is at most the node's radius away from it.
bool TriangleTree::WindingInBall::isLikeDipole(const Dipole& dipole) {
  const double gap = glm::distance(dipole.center, center_) - radius_ - dipole.radius;
  return gap > 0.0 && isError(2.0 * dipole.area * dipole.radius / (gap * gap * gap));
}

// Whether a term may have a linear function, by a bound of its second derivative in the ball.
bool TriangleTree::WindingInBall::isLinear(double secondDerivative) {
  return isError(0.5 * radius_ * radius_ * secondDerivative);
}

// Adds an error, in steradians, if it is small enough.
bool TriangleTree::WindingInBall::isError(double angle) {
  const double error = angle / kSphere;
  if (!(error <= kLargestError) || error_ + error > kLargestSum) return false;
  error_ += error;
  return true;
}

void TriangleTree::WindingInBall::addNode(const Range& range) {
  const Dipole& dipole = tree_->dipoles_[range.node];
  const glm::dvec3 apart = dipole.center - center_;
  const double squared = glm::dot(apart, apart), distance = std::sqrt(squared);
  const double least = distance - radius_;
  if (!(least > 0.0) ||
      !isLinear(6.0 * glm::length(dipole.normal) / (least * least * least * least))) {
    dipoles_.push_back(static_cast<std::uint32_t>(range.node));
    return;
  }
  const double cubed = squared * distance, along = glm::dot(dipole.normal, apart);
  angle_ += along / cubed;
  gradient_ += (3.0 * along / squared * apart - dipole.normal) / cubed;
}

void TriangleTree::WindingInBall::addTriangle(std::size_t triangle) {
  const std::array<glm::dvec3, 3> t = tree_->corners(triangle);
  const double least =
      glm::distance(center_, nearestOnTriangle(center_, t[0], t[1], t[2])) - radius_;
  const double area = 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
  if (!(least > 0.0) || !isLinear(6.0 * area / (least * least * least * least))) {
    triangles_.push_back(static_cast<std::uint32_t>(triangle));
    return;
  }
  SolidAngles angle;
  angle.add(t, center_);
  angle_ += angle.sum();
  gradient_ += gradientOf(t, center_);
}

double TriangleTree::WindingInBall::at(const glm::dvec3& point) const {
  double angle = angle_ + glm::dot(gradient_, point - center_);
  for (const std::uint32_t node : dipoles_) {
    const Dipole& dipole = tree_->dipoles_[node];
    const glm::dvec3 apart = dipole.center - point;
    const double squared = glm::dot(apart, apart);
    angle += glm::dot(dipole.normal, apart) / (squared * std::sqrt(squared));
  }
  SolidAngles near;
  for (const Mixed& m : mixed_)
    angle += tree_->addSolidAngles({m.node, m.begin, m.end, m.levelsBelow}, point, near);
  for (const std::uint32_t triangle : triangles_) near.add(tree_->corners(triangle), point);
  return (angle + near.sum()) / kSphere;
}

}  // namespace sherd
