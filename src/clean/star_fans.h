// Whether the surfaces of pieces stay manifold.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "clean/change.h"

namespace sherd {

/// A face at a vertex: the two others of its corners, in order.
struct Spoke {
  std::uint16_t piece = 0;
  std::uint32_t from = 0, to = 0;
};
[[nodiscard]] Spoke spokeOf(const glm::uvec3& corner, std::uint16_t piece, std::uint32_t at);

/// Faces at a vertex, by piece, then by Spoke::from.
using Spokes = std::vector<Spoke>;
[[nodiscard]] Spokes sorted(Spokes spokes);

/// What fansOf returns of faces that are not made of whole fans.
inline constexpr int kNoFans = -1;

/// Returns the number of fans that a piece has, each closed and of three faces or more.
///   spokes  sorted
[[nodiscard]] int fansOf(const Spokes& spokes, std::uint16_t piece);

/// Returns whether every piece has as many fans around the merged vertices as it had, less the one
/// of an edge that vanishes: no edge gets more than two faces in a piece, no parts of a piece are
/// joined in a vertex, and no piece folds to a sheet.
[[nodiscard]] bool keepsFans(const Stars& stars, const Change& change);

}  // namespace sherd
