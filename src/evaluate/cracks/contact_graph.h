// Which fragments touch, and what their order says about it.
#pragma once

#include <sherd/evaluate.h>

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "evaluate/cracks/fragment_shape.h"

namespace sherd {

/// Fragments and their contacts.
struct ContactGraph {
  std::vector<std::pair<std::size_t, std::size_t>> contacts{};  ///< indices, the lower first, once
  std::vector<std::size_t> object{};                            ///< [n] 0..objects-1 of a fragment
  std::size_t objects = 0;  ///< sets of fragments that no contact joins
};

/// Two fragments touch where a crack of at least the least area names the other one, on either
/// side.
///   ids  [n] of the fragments
[[nodiscard]] ContactGraph contactGraph(std::span<const DividedMesh> meshes,
                                        std::span<const int> ids, double leastArea);

/// Returns the share of pairs with consecutive ids that touch, less that of all pairs.  Nothing
/// without two pairs, one of them consecutive.
[[nodiscard]] std::optional<double> consecutiveExcess(const ContactGraph& graph,
                                                      std::span<const int> ids);

}  // namespace sherd
