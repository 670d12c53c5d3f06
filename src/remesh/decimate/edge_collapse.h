// Edge collapses that preserve the topology of a complex.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "remesh/complex.h"

namespace sherd {

/// The connectivity of closed meshes that share faces, or of surfaces of which no mesh is made
/// (LabeledComplex::labels 0), which may be open.  A region is the set of faces between the same
/// two labels, or of one label with the same neighbor, and of the same chart.
///
/// A boundary edge has faces of several regions, or any number but two of them.  A vertex is free
/// if it has no boundary edges, on a boundary if it has two, and fixed if it has any other number.
class CollapsingMesh {
 public:
  using Index = std::uint32_t;

  explicit CollapsingMesh(const LabeledComplex& complex);

  std::size_t trianglesLeft(std::uint16_t label) const { return left_[label]; }
  std::uint16_t labels() const { return labels_; }
  const std::vector<ComplexFace>& faces() const { return faces_; }  ///< corners 0 once collapsed
  const std::vector<Index>& facesAround(Index v) const { return around_[v]; }

  bool has(Index f, Index v) const {
    const glm::uvec3& corner = faces_[f].corner;
    return corner.x == v || corner.y == v || corner.z == v;
  }
  std::vector<Index> neighbors(Index v) const;  ///< ascending

  bool isBoundary(Index a, Index b) const;
  int boundaryEdges(Index v) const;

  /// Returns the labels whose surfaces contain an edge, ascending.
  std::vector<std::uint16_t> labelsAt(Index a, Index b) const;

  /// Returns true if collapsing an edge preserves the topology of every label's surface and of the
  /// regions: the link condition holds on each surface, of surfaces without meshes on all of them
  /// together, and no region loses its last triangle.
  /// Precondition: if neither end is free, the edge is a boundary edge.
  ///   source  Dey et al., Topology preserving edge contraction, 1999
  bool keepsTopology(Index a, Index b) const;

  /// Collapses an edge into its vertex `a`.
  void collapse(Index a, Index b);

 private:
  // A region's key: its two labels, or the label that has a mesh and its neighbor; and its chart.
  std::uint64_t region(Index f) const;
  bool keepsLink(Index a, Index b) const;
  std::vector<Index> neighborsOn(std::uint16_t label, Index v) const;

  std::vector<ComplexFace> faces_;
  std::vector<std::vector<Index>> around_;  // [vertices] faces, none once collapsed
  std::uint16_t labels_;
  std::vector<std::size_t> left_;  // [labels + 1]
};

}  // namespace sherd
