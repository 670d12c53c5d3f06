// Parts sheets of one label's surface that touch in a point.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "surface/rims.h"

namespace sherd {

/// The vertices of the mesh of all labels.  Those of several labels at one place have the same
/// position, and belong to one label each.
struct InterfaceVertices {
  std::vector<glm::dvec3> at;        ///< index space
  std::vector<std::uint32_t> place;  ///< equal where they share a position
  std::uint32_t places = 0;
};

/// A face that fills a gap between two labels, seen from one side.
struct InterfaceTriangle {
  std::uint16_t label = 0;
  std::uint16_t other = 0;
  std::array<std::uint32_t, 3> vertex{};
};

/// Where a label has two vertices at one place two sheets of its surface touch, which is no
/// manifold to a reader who joins equal positions.  Move one of them a tenth of a voxel into the
/// label's own inside, and what the neighbours have there with it: the neighbours share out the
/// room, so along each line between two of them a triangle fills the gap.  Nothing opens, and the
/// two sides of every face stay the same to the bit.
///
/// A sheet stays where it is where parting it would bring two sheets of a neighbour together.
///   crowded  places where a label has several vertices
///   quads    [leaves][..] those of two labels about one edge follow each other
///   return   the triangles in the gaps, of every label but Labels::kWorn
[[nodiscard]] std::vector<InterfaceTriangle> partTouchingSheets(
    std::span<const std::uint32_t> crowded, std::span<std::vector<InterfaceQuad>> quads,
    InterfaceVertices& vertices);

}  // namespace sherd
