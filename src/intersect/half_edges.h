// A triangulation of a triangle as half edges.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

namespace sherd {

/// A triangulation of one triangle, vertices 0, 1, 2, to which points are added.  Half edges 2e and
/// 2e + 1 are the two directions of edge e; numbers of edges stay valid.
///
///               c                 A half edge h is directed from `origin` to `target`, and
///             /   \               its triangle is on its left.  The outer half edges have
///      after /     \ next         no triangle.
///           /       \             .
///          a ------> b
///               h
class HalfEdges {
 public:
  using Index = std::uint32_t;
  static constexpr Index kNone = std::numeric_limits<Index>::max();

  ///   points  the number of points that the triangulation will have, at least 3
  explicit HalfEdges(std::size_t points);

  [[nodiscard]] static Index twin(Index h) { return h ^ 1u; }
  [[nodiscard]] Index next(Index h) const { return next_[h]; }
  [[nodiscard]] Index after(Index h) const { return next_[next_[h]]; }
  [[nodiscard]] Index origin(Index h) const { return origin_[h]; }
  [[nodiscard]] Index target(Index h) const { return origin_[twin(h)]; }
  [[nodiscard]] Index apex(Index h) const { return origin_[after(h)]; }
  [[nodiscard]] bool isOuter(Index h) const { return next_[h] == kNone; }
  [[nodiscard]] bool isBoundary(Index h) const { return isOuter(h) || isOuter(twin(h)); }
  [[nodiscard]] std::size_t halfEdges() const { return next_.size(); }

  /// Returns a half edge from a point that was added; never an outer one.
  [[nodiscard]] Index from(Index point) const { return from_[point]; }

  /// Returns all half edges with a triangle from a point, counter-clockwise from the boundary if
  /// the point is on it.
  [[nodiscard]] std::vector<Index> around(Index point) const;

  /// The segment that an edge is a part of, or kNone.
  [[nodiscard]] Index segment(Index h) const { return segment_[h / 2]; }
  void setSegment(Index h, Index segment) { segment_[h / 2] = segment; }

  /// Adds a point inside the triangle of a half edge.
  void splitTriangle(Index h, Index point);
  /// Adds a point on an edge, which must not be a segment's.
  void splitEdge(Index h, Index point);

  /// Replaces an inner edge by the other diagonal of its two triangles; `h` is then directed from
  /// the apex of the other triangle to that of its own.
  void flip(Index h);

 private:
  Index addEdge(Index origin, Index target);
  void makeTriangle(Index a, Index b, Index c);

  std::vector<Index> origin_, next_;  // [half edges]
  std::vector<Index> segment_;        // [edges]
  std::vector<Index> from_;           // [points]
};

}  // namespace sherd
