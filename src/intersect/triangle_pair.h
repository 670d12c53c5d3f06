// Where two triangles in general position cross.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace sherd {

/// A triangle of one of two meshes.
struct PairTriangle {
  std::uint32_t index = 0;  ///< of the triangle
  glm::uvec3 vertex{0};     ///< of the corners, in the triangle's mesh
  std::array<glm::dvec3, 3> corner{};
};

/// The point where an edge of one mesh crosses a triangle of the other.  Equal for all triangles
/// that have the edge.
struct CrossingKey {
  bool isCutterEdge = false;
  std::uint32_t low = 0, high = 0;  ///< the edge's vertices
  std::uint32_t triangle = 0;       ///< of the other mesh

  auto operator<=>(const CrossingKey&) const = default;
};

/// How two triangles meet.
struct TrianglePair {
  enum class Kind { apart, crossing, degenerate } kind = Kind::apart;

  /// The ends of the crossing, directed along cross(surface's normal, cutter's normal): on its left
  /// the surface's triangle is behind the cutter's, and the cutter's in front of the surface's.
  CrossingKey from, to;

  /// Of a degenerate pair: the cutter's vertices that are in a plane of the surface's triangle or
  /// belong to an edge or triangle that meets its edges or corners; may repeat.
  std::vector<std::uint32_t> cutterVertices;
  bool isSurfaceFlat = false;  ///< the surface's triangle has no area, and the cutter meets it
};

/// Decides how two triangles meet, exactly.  Touching only counts where the triangles have a point
/// in common.
[[nodiscard]] TrianglePair meetingOf(const PairTriangle& surface, const PairTriangle& cutter);

}  // namespace sherd
