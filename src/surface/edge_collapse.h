// Which edges of a mesh may be collapsed without a change of its topology, and collapsing them.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// The connectivity of a closed mesh with regions of equal facing.
///
/// A rim edge has faces of two facings.  A vertex is free without rim edges, on a rim with two, and
/// fixed with any other number: there more than two regions meet.
class CollapsingMesh {
 public:
  using Index = std::uint32_t;

  CollapsingMesh(const TriangleMesh& mesh, std::span<const std::uint16_t> facing);

  std::size_t trianglesLeft() const { return left_; }
  std::size_t vertices() const { return around_.size(); }
  const std::vector<glm::uvec3>& faces() const { return faces_; }  ///< all corners 0 once collapsed
  const std::vector<Index>& facesAround(Index v) const { return around_[v]; }
  std::uint16_t facing(Index f) const { return facing_[f]; }

  bool has(Index f, Index v) const {
    return faces_[f].x == v || faces_[f].y == v || faces_[f].z == v;
  }
  std::vector<Index> neighbours(Index v) const;  ///< ascending

  bool isRim(Index a, Index b) const;
  int rimEdges(Index v) const;

  /// Whether collapsing an edge leaves the surface what it is, and the regions too, provided that
  /// its ends are not two rims' or fixed vertices with no rim between them.  The link condition,
  /// and no region's last triangle.
  ///   source  Dey et al., Topology preserving edge contraction, 1999
  bool keepsTopology(Index a, Index b) const;

  /// Collapse an edge into its vertex `a`.
  void collapse(Index a, Index b);

 private:
  std::vector<glm::uvec3> faces_;
  std::vector<std::uint16_t> facing_;
  std::vector<std::vector<Index>> around_;  // [vertices] faces, none once collapsed
  std::size_t left_;
};

}  // namespace sherd
