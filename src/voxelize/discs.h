// Triangles near some voxels, each in a disc, to find the nearest of them soon.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "mesh/triangle_tree.h"

namespace sherd {

/// Some triangles of a tree.  A disc holds each: the distance to it is a bound of the triangle's,
/// close where triangles are not long and thin, and taken of several at a time.
class Discs {
 public:
  ///   origin     near all points that will be asked for: discs are in single precision about it
  ///   triangles  in the tree's order
  void assign(const TriangleTree& tree, const glm::dvec3& origin,
              std::span<const std::uint32_t> triangles);

  /// Take over those of others that may be less than `reach` away from the point that these were
  /// asked for last.
  void assign(Discs& others, double reach);

  /// As TriangleTree::nearest, of these triangles; the distance is the same to the bit.
  ///   guess  one of the tree's triangles, or none
  [[nodiscard]] TriangleTree::Nearest nearest(const glm::dvec3& point, double reach,
                                              std::uint32_t guess);

 private:
  void measure(const glm::dvec3& point);
  [[nodiscard]] std::span<std::uint32_t> below(float limit);

  enum Column { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kRadius, kSlack, kColumns };

  const TriangleTree* tree_ = nullptr;
  glm::dvec3 origin_{0.0};
  std::vector<std::uint32_t> triangles_;
  std::array<std::vector<float>, kColumns> columns_;
  std::vector<float> squared_;         // no more than the squared distances to the last point
  std::vector<std::uint32_t> chosen_;  // places of some triangles
};

}  // namespace sherd
