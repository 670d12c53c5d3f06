// Moves the vertices of rims to where they belong.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// A face of the mesh of all labels, seen from one side: its corners lie in the four cells about a
/// voxel edge, counter-clockwise from outside the label.
struct InterfaceQuad {
  std::uint16_t label = 0;  ///< whose surface it is, never 0
  std::uint16_t other = 0;  ///< what is beyond
  std::array<std::uint32_t, 4> vertex{};
};

/// Its two triangles, split at the shorter diagonal, which both sides of an interface find the
/// same.
[[nodiscard]] std::array<std::array<std::uint32_t, 3>, 2> trianglesOf(
    const InterfaceQuad& quad, std::span<const glm::dvec3> vertices);

/// A place where more than two labels meet, and that cannot be reached within its cell.
struct Junction {
  std::vector<std::uint32_t> vertices;  ///< of each label there one or more, all at one place
  glm::dvec3 wanted{0.0};
};

/// Move junctions to the places they want, or as near as no triangle there gets bad: turned by more
/// than 45 degrees from where its quad was, or smaller than a hundredth of a voxel's face.
/// What is bad already may stay so, but gets no worse.  One after the other, twice, as a
/// neighbour's move may make room.
///
/// The labels decide which cells a rim passes through, and a crack that crosses the surface beside
/// such a cell would have its rim off, to and fro.
///   quads     [leaves][..]
///   vertices  index space
void straightenRims(std::span<const std::vector<InterfaceQuad>> quads,
                    std::span<const Junction> junctions, std::vector<glm::dvec3>& vertices);

}  // namespace sherd
