// Vertices at one position.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/vec3.hpp>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

namespace sherd {

/// Returns for each vertex the least one at its position.
///   cost  vertices * log(vertices)
[[nodiscard]] inline std::vector<std::uint32_t> firstAtPosition(
    std::span<const glm::dvec3> vertices) {
  std::vector<std::uint32_t> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const glm::dvec3 &p = vertices[a], &q = vertices[b];
    return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool isNew = i == 0 || vertices[order[i]] != vertices[order[i - 1]];
    first[order[i]] = isNew ? order[i] : first[order[i - 1]];
  }
  return first;
}

}  // namespace sherd
