// The borders of facets as chains of edges, which the facets on all sides share.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <tuple>
#include <vector>

#include "remesh/decimate/facets.h"
#include "remesh/face_edges.h"

namespace sherd {

/// A directed edge of a facet's border, with the facet on its left.
struct Side {
  std::uint32_t from = 0, to = 0;
  std::uint32_t chain = 0;

  [[nodiscard]] auto ends() const { return std::tie(from, to); }
};

/// Chains of border edges with the same facets beside them, each with some of its vertices left
/// out: those that are within a tolerance of the line between the kept ones.
class FacetChains {
 public:
  /// Chains without a common facet that keep the same two neighboring vertices are refined until
  /// none do, because their facets would touch there.
  /// Chains beside faces of no facet keep all their vertices.
  ///   edges, facets, positions  referenced; positions: [vertices]
  /// The tolerance of a chain is the least of those of the facets beside it.
  FacetChains(const FaceEdges& edges, const Facets& facets, std::span<const glm::dvec3> positions);

  [[nodiscard]] const glm::dvec3& position(std::uint32_t vertex) const {
    return positions_[vertex];
  }

  /// Returns the chains on a facet's border, ascending.
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t facet) const {
    return ofFacet_[facet];
  }

  /// Returns the sides of a facet's polygon; two opposite ones cancel.
  [[nodiscard]] std::vector<Side> sidesOf(std::uint32_t facet) const;

  /// Keeps more vertices of chains, and adds the facets beside those that change.
  void refine(std::span<const std::uint32_t> chains, std::vector<std::uint32_t>& facets);

  /// Keeps all vertices of chains, and adds the facets beside those that change.
  void keepAll(std::span<const std::uint32_t> chains, std::vector<std::uint32_t>& facets);

 private:
  struct Beside {
    std::uint32_t facet = 0;
    bool isForward = false;  // the facet is on the left
  };
  struct Chain {
    std::vector<std::uint32_t> vertices;
    std::vector<std::uint32_t> kept;  // of `vertices`, both ends included
    std::vector<Beside> facets;
    bool isFixed = false;    // beside a face of no facet
    double own = 0.0;        // tolerance at first
    double tolerance = 0.0;  // of `kept`; 0: all are kept
  };

  [[nodiscard]] bool isBorder(std::size_t edge) const;
  void findChains();
  [[nodiscard]] bool isEnd(std::span<const std::uint32_t> edges) const;
  void addFacets(std::uint32_t edge, std::uint32_t from, Chain& chain) const;
  void add(Chain chain);

  void setTolerance(Chain& chain, double tolerance) const;
  [[nodiscard]] std::size_t farthestFromFirst(const Chain& chain) const;
  void keepBetween(const Chain& chain, std::size_t from, std::size_t to,
                   std::vector<bool>& keeps) const;

  void separateChains();
  [[nodiscard]] std::vector<std::uint32_t> touchingChains() const;
  [[nodiscard]] bool haveCommonFacet(std::uint32_t a, std::uint32_t b) const;

  const FaceEdges& edges_;
  const Facets& facets_;
  const std::span<const glm::dvec3> positions_;
  std::vector<Chain> chains_;
  std::vector<std::vector<std::uint32_t>> ofFacet_;  // [facets] chains
};

}  // namespace sherd
