// Where the input's triangles cross the edges of cells.
#pragma once

#include <sherd/solid.h>

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "mesh/search/triangle_tree.h"

namespace sherd {

/// Where a triangle crosses the edge between two voxel centers, one inside and one outside.
struct InputCrossing {
  double at = 0.0;             ///< from the lower end, 0..1
  glm::dvec3 normal{0.0};      ///< unit, outwards
  std::uint32_t triangle = 0;  ///< in the tree's order
};

/// An edge between two voxel centers, one inside and one outside.
struct CrossedEdge {
  openvdb::Coord low;        ///< its lower voxel, from the leaf's lowest, 0..8 along each axis
  std::uint8_t axis = 0;     ///< that it is along
  bool isLowInside = false;  ///< whether the lower voxel is the one inside
};

/// The crossing of an edge that was found before.
struct KnownCrossing {
  std::uint16_t edge = 0;  ///< 3 times the place of its lower voxel among the 9*9*9, plus the axis
  std::optional<InputCrossing> crossing{};
};

/// The crossings of one leaf's cells, each found once.  Solids of volumes and shells have none.
class InputCrossings {
 public:
  ///   origin  lowest voxel of the leaf
  ///   known   ascending by edge
  InputCrossings(const Solid& solid, const openvdb::Coord& origin,
                 std::span<const KnownCrossing> known = {});

  /// Returns whether crossings may differ from those of the distances: not where the distances at
  /// the corners of a cell are those to one plane.
  [[nodiscard]] bool areNeededFor(const std::array<float, 8>& toSurface) const;

  /// Returns whether the solid has triangles that bound it.
  [[nodiscard]] bool exist() const { return tree_ != nullptr; }

  /// Finds the crossings of edges at once if that is faster, for on().
  ///   edges  different ones
  void find(std::span<const CrossedEdge> edges);

  /// Returns the crossing of an edge; nullopt where no triangle crosses it, as in holes.
  [[nodiscard]] const std::optional<InputCrossing>& on(const CrossedEdge& edge);

  /// Returns all that were found, ascending by edge.
  [[nodiscard]] std::vector<KnownCrossing> found() const;

 private:
  using Segment = std::array<glm::dvec3, 2>;  // from outside to inside

  [[nodiscard]] static std::uint16_t numberOf(const CrossedEdge& edge);
  [[nodiscard]] std::uint16_t& indexOf(const CrossedEdge& edge);
  [[nodiscard]] Segment segmentOf(const CrossedEdge& edge) const;
  [[nodiscard]] std::optional<InputCrossing> crossingOf(
      const CrossedEdge& edge, const Segment& segment,
      const std::optional<TriangleTree::Hit>& hit) const;

  static constexpr std::uint16_t kUnknown = 0xffff;
  const TriangleTree* tree_;  // null if there are no crossings
  std::span<const KnownCrossing> known_;
  glm::dvec3 origin_;
  double voxelSize_;
  bool areTrianglesFew_;              // in a leaf, on average
  std::vector<std::uint16_t> index_;  // [9][9][9][axis] into all_, or kUnknown
  std::vector<std::optional<InputCrossing>> all_;
};

}  // namespace sherd
