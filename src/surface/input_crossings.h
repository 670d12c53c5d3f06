// Where the input's triangles cross the edges of cells.
#pragma once

#include <sherd/solid.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "mesh/triangle_tree.h"

namespace sherd {

/// Where a triangle crosses the edge between two voxel centers, one inside and one outside.
struct InputCrossing {
  double at = 0.0;         ///< from the lower end, 0..1
  glm::dvec3 normal{0.0};  ///< unit, outwards
};

/// The crossings of one leaf's cells, each found once.  Solids of volumes and shells have none.
class InputCrossings {
 public:
  ///   origin  lowest voxel of the leaf
  InputCrossings(const Solid& solid, const openvdb::Coord& origin);

  /// Returns whether crossings may differ from those of the distances: not where the distances at
  /// the corners of a cell are those to one plane.
  [[nodiscard]] bool areNeededFor(const std::array<float, 8>& toSurface) const;

  /// Returns whether the solid has triangles that bound it.
  [[nodiscard]] bool exist() const { return tree_ != nullptr; }

  /// Returns the crossing of an edge; nullopt where no triangle crosses it, as in holes.
  ///   low         the edge's lower voxel, from the leaf's lowest, 0..8 along each axis
  ///   isLowInside  whether that is the voxel inside
  [[nodiscard]] const std::optional<InputCrossing>& on(const openvdb::Coord& low, unsigned axis,
                                                       bool isLowInside);

 private:
  [[nodiscard]] std::optional<InputCrossing> found(const openvdb::Coord& low, unsigned axis,
                                                   bool isLowInside) const;

  static constexpr std::uint16_t kUnknown = 0xffff;
  const TriangleTree* tree_;  // null if there are no crossings
  glm::dvec3 origin_;
  double voxelSize_;
  std::vector<std::uint16_t> index_;  // [9][9][9][axis] into all_, or kUnknown
  std::vector<std::optional<InputCrossing>> all_;
};

}  // namespace sherd
