// Triangles that a mesh has several times.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// Returns the triangles to keep, ascending: one of those with the same corners, or none if as many
/// have one orientation as the other.  More of them are kept where edges balance only with them:
/// two bodies that touch have a face twice there, while a repeated sheet balances without its
/// copies.
[[nodiscard]] std::vector<std::uint32_t> withoutDuplicates(std::span<const glm::uvec3> triangles);

}  // namespace sherd
