// Triangles that a mesh has several times.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "mesh/repair/sheets.h"

namespace sherd {

struct OnceTriangles {
  std::vector<std::uint32_t> kept;  ///< ascending
  std::vector<SheetFace> sheets;    ///< those of which neither side is kept
};

/// Returns the triangles to keep: one of those with the same corners, or none if as many have one
/// orientation as the other.  More of them are kept where edges balance only with them: two bodies
/// that touch have a face twice there, while a repeated sheet balances without its copies.  A
/// closed surface of which every triangle is there from both sides keeps those that come first,
/// which may have to be oriented.
[[nodiscard]] OnceTriangles withoutDuplicates(std::span<const glm::uvec3> triangles);

}  // namespace sherd
