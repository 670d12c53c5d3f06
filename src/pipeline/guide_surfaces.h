// The surfaces of given cracks.
#pragma once

#include <sherd/fracture.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "mesh/search/sided_mesh.h"

namespace sherd {

/// The surfaces of given cracks, guide by guide.
struct GuideSurfaces {
  std::vector<SidedMesh> surfaces{};
  std::vector<std::size_t> guide{};  ///< [surfaces] index of the one that each is of
};

/// Returns a surface for each polyline and each connected component of the guides' meshes, in this
/// order.
///   throws  Error(input) naming the guide: a polyline without a length or far from the solid, a
///           value that is not finite, nothing in it; Error(cancelled)
[[nodiscard]] GuideSurfaces guideSurfacesOf(std::span<const Guide> guides, const Solid& solid,
                                            const Progress* progress = nullptr);

/// Returns a sentence for each guide of which a line or a component, or all, split nothing.
///   guide   [surfaces] as GuideSurfaces
///   guided  for each split by a surface, its number
///   splits  all, also those by no surface
[[nodiscard]] std::vector<std::string> guideWarnings(std::span<const Guide> guides,
                                                     std::span<const std::size_t> guide,
                                                     std::span<const std::size_t> guided,
                                                     std::size_t splits);

}  // namespace sherd
