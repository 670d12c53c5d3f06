// Straightens contact boundaries: the lines where several labels meet.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// The diagonal at which a quad is split: preferred, if both are in it; of a settled quad, used.
enum class QuadSplit : std::uint8_t {
  shorter,  ///< the shorter one
  first,    ///< of vertices 0 and 2
  second,   ///< of vertices 1 and 3
};

/// One side of a face of the mesh of all labels.  Its corners lie in the four cells around the edge
/// between two voxel centers, counter-clockwise from outside the label.
struct InterfaceQuad {
  std::uint16_t label = 0;  ///< never 0
  std::uint16_t other = 0;  ///< label on the other side
  std::array<std::uint32_t, 4> vertex{};
  std::uint16_t edge = 0;  ///< between the two voxel centers: 3 times the offset of the lower one
                           ///< in its leaf, plus the axis
  QuadSplit split = QuadSplit::shorter;
  bool isIntact = false;  ///< of the intact solid: settled, and no vertex is a junction's

  [[nodiscard]] int axis() const { return edge % 3; }
};

/// Returns the eighth of a leaf that an edge belongs to: of half its side along each axis.
[[nodiscard]] inline std::size_t octantOf(std::uint16_t edge) {
  const unsigned offset = edge / 3u;
  return (offset >> 6 & 4) | (offset >> 4 & 2) | (offset >> 2 & 1);
}

/// The two triangles of a quad, by their corners.
using QuadHalves = std::array<std::array<std::uint32_t, 3>, 2>;

/// Settles the diagonal at which a quad is split, so that its triangles do not fold seen along its
/// axis, if one of the diagonals allows it.  Both sides of an interface get the same.
[[nodiscard]] QuadSplit settledSplit(const InterfaceQuad& quad,
                                     std::span<const glm::dvec3> vertices);

/// Returns the two triangles of four corners split at a settled diagonal.
[[nodiscard]] inline QuadHalves trianglesOf(const std::array<std::uint32_t, 4>& v,
                                            QuadSplit settled) {
  if (settled == QuadSplit::first) return {{{v[0], v[1], v[2]}, {v[0], v[2], v[3]}}};
  return {{{v[1], v[2], v[3]}, {v[1], v[3], v[0]}}};
}

/// Returns the two triangles of a quad.
[[nodiscard]] inline QuadHalves trianglesOf(const InterfaceQuad& quad,
                                            std::span<const glm::dvec3> vertices) {
  return trianglesOf(quad.vertex, settledSplit(quad, vertices));
}

/// A position where more than two labels meet that has a target: outside its cell, or on a crease.
struct Junction {
  glm::dvec3 target{0.0};
  glm::dvec3 normal{0.0};   ///< of the solid's surface at it, unit; 0 on a crease
  bool isOnCrease = false;  ///< of the input: triangles rotate by up to 60 degrees then, as a
                            ///< corner needs
  std::uint32_t count = 0;
  std::array<std::uint32_t, 24> all{};  ///< as many as a cell has sheets at most

  /// One or more per label, all at one position.
  [[nodiscard]] std::span<const std::uint32_t> vertices() const { return {all.data(), count}; }
  [[nodiscard]] std::span<std::uint32_t> vertices() { return {all.data(), count}; }
  void add(std::uint32_t vertex) { all[count++] = vertex; }
};

/// Moves junctions to their targets, or as far as no triangle degenerates: rotates by more than 45
/// degrees from its quad's first normal, on creases 60, or gets smaller than a hundredth of a
/// voxel's face. Degenerate triangles do not get worse.  Where that
/// is not the whole way, a junction moves onto the surface, if that leaves no triangle degenerate.
/// Two passes over all junctions, because a move may make room for its neighbors.
///
/// Without it boundaries zigzag where a crack crosses the surface outside the cells that the labels
/// select.
///   quads     [leaves][..] not settled, unless they are of the intact solid
///   vertices  index space
///   mayHave   returns false for leaves of which no quad has a vertex of a junction
void straightenBoundaries(std::span<const std::vector<InterfaceQuad>> quads,
                          std::span<const Junction> junctions, std::vector<glm::dvec3>& vertices,
                          const std::function<bool(std::size_t)>& mayHave);

}  // namespace sherd
