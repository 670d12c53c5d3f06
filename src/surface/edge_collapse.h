// Which edges of a complex may be collapsed without a change of its topology, and collapsing them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "surface/complex.h"

namespace sherd {

/// The connectivity of closed meshes that share faces, with regions: faces between the same two
/// labels, or of one label facing the same.
///
/// A rim edge has faces of several regions.  A vertex is free without rim edges, on a rim with two,
/// and fixed with any other number: there more than one rim ends.
class CollapsingMesh {
 public:
  using Index = std::uint32_t;

  explicit CollapsingMesh(const Complex& complex);

  std::size_t trianglesLeft(std::uint16_t label) const { return left_[label]; }
  std::uint16_t labels() const { return labels_; }
  const std::vector<ComplexFace>& faces() const { return faces_; }  ///< corners 0 once collapsed
  const std::vector<Index>& facesAround(Index v) const { return around_[v]; }

  bool has(Index f, Index v) const {
    const glm::uvec3& corner = faces_[f].corner;
    return corner.x == v || corner.y == v || corner.z == v;
  }
  std::vector<Index> neighbours(Index v) const;  ///< ascending

  bool isRim(Index a, Index b) const;
  int rimEdges(Index v) const;

  /// The labels with a mesh whose surface has an edge, ascending.
  std::vector<std::uint16_t> labelsAt(Index a, Index b) const;

  /// Whether collapsing an edge leaves every label's surface what it is, and the regions too,
  /// provided that its ends are not two rims' or fixed vertices with no rim between them.  The link
  /// condition on each label's surface, and no region's last triangle.
  ///   source  Dey et al., Topology preserving edge contraction, 1999
  bool keepsTopology(Index a, Index b) const;

  /// Collapse an edge into its vertex `a`.
  void collapse(Index a, Index b);

 private:
  // Regions are told by the two labels, or by the one that has a mesh and what it faces.
  std::uint64_t region(Index f) const;
  std::vector<Index> neighboursOn(std::uint16_t label, Index v) const;

  std::vector<ComplexFace> faces_;
  std::vector<std::vector<Index>> around_;  // [vertices] faces, none once collapsed
  std::uint16_t labels_;
  std::vector<std::size_t> left_;  // [labels + 1]
};

}  // namespace sherd
