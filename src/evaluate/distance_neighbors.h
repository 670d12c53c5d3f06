// Neighbors of triangles by distance, for meshes that do not record them.
#pragma once

#include <sherd/evaluate.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// What is behind a fragment's triangles.
struct BehindTriangles {
  std::vector<std::uint16_t>
      neighbor{};  ///< [m] id, 0 for the original surface: most of its points
  std::vector<std::pair<int, double>> areas{};  ///< area of crack towards each id, ascending
};

/// Classifies triangles as fit() does points: those inside another fragment, or with one within the
/// tolerance in the direction of the normal, are cracks.  A triangle is sampled at
/// its pointsOn().
///   fragments  closed meshes oriented outwards
///   throws     Error(cancelled)
[[nodiscard]] std::vector<BehindTriangles> neighborsByDistance(
    std::span<const FragmentMesh> fragments, double tolerance, double spacing,
    const Progress* progress);

}  // namespace sherd
