// The polygon of a facet, triangulated.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "remesh/decimate/facet_chains.h"
#include "remesh/decimate/facets.h"

namespace sherd {

/// The triangles of a facet's polygon, or where its border crosses itself: chains and vertices.
struct FacetPolygon {
  bool isMade = false;
  std::vector<glm::uvec3> triangles{};              ///< of vertices
  std::vector<std::uint32_t> chains{}, vertices{};  ///< ascending; empty if it is made
};

/// Returns the polygon that a facet's sides enclose, triangulated in the facet's plane.  No
/// triangle if all sides cancel.
///   sides  FacetChains::sidesOf the facet
///   cost  about sides * log(sides)
[[nodiscard]] FacetPolygon polygonOf(std::uint32_t facet, std::span<const Side> sides,
                                     const FacetChains& chains, const Facets::Plane& plane);

}  // namespace sherd
