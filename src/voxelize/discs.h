// Triangles near some voxels, each bounded by a disc, for fast nearest-triangle search.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "mesh/search/triangle_tree.h"

namespace sherd {

/// Some triangles of a tree, each bounded by a disc.  The distance to the disc is a lower bound of
/// that to the triangle, tight unless the triangle is long and thin, and vectorizes.  Where it does
/// not decide, the triangle is bounded by the lines of its edges: a tight bound except beside its
/// corners.
class Discs {
 public:
  ///   origin     near all query points: discs are stored in single precision relative to it
  ///   triangles  in the tree's order
  void assign(const TriangleTree& tree, const glm::dvec3& origin,
              std::span<const std::uint32_t> triangles);

  /// Copies from `others` the triangles that may be nearer than `reach` to the point of their last
  /// query.
  void assign(Discs& others, double reach);

  /// As TriangleTree::nearest for these triangles; the distance is bitwise the same.
  ///   guess  one of the tree's triangles, or kNone
  [[nodiscard]] TriangleTree::Nearest nearest(const glm::dvec3& point, double reach,
                                              std::uint32_t guess);

 private:
  using Floats = float __attribute__((vector_size(16)));

  // The signed distances of a point beyond the edges of a triangle, in its plane, are
  // normalX * x + normalY * y + normalZ * z - offset for a point relative to its center; the fourth
  // is the third.
  struct Edges {
    Floats normalX, normalY, normalZ, offset;
  };
  [[nodiscard]] static Edges edgesOf(const std::array<glm::dvec3, 3>& t, const glm::dvec3& center,
                                     const glm::dvec3& normal);

  void measure(const glm::dvec3& point);
  void narrow(const glm::vec3& p, std::uint32_t index);
  [[nodiscard]] std::span<std::uint32_t> below(float limit);

  enum Column { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kRadius, kSlack, kColumns };

  const TriangleTree* tree_ = nullptr;
  glm::dvec3 origin_{0.0};
  std::vector<std::uint32_t> triangles_;
  std::vector<Edges> ownEdges_;        // of a list that is not a copy
  const Edges* edges_ = nullptr;       // those of the list that this one was copied from
  std::vector<std::uint32_t> number_;  // indices into edges_
  std::array<std::vector<float>, kColumns> columns_;
  std::vector<float> squared_;         // lower bounds of squared distances to the last query point
  std::vector<std::uint32_t> chosen_;  // indices into triangles_
};

}  // namespace sherd
