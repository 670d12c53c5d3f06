// Bodies of a mesh that have nothing in common, with the fragments that are of them.
#pragma once

#include <sherd/labels.h>
#include <sherd/progress.h>
#include <sherd/solid.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// Bodies that can't be cut one without the others.
struct BodyCluster {
  std::vector<std::uint32_t> triangles{};  ///< of the mesh, ascending
  std::vector<std::uint16_t> fragments{};  ///< ascending, at least one
};

/// Splits a mesh into clusters: components that touch or cross each other are in one, and those
/// that have voxels of fragments which touch, or of the same one.  A component that has no voxels
/// belongs to the nearest.
///   solid   that the labels are of
///   mesh    the solid's, with the faces that close its holes, if any, after its own
///   labels  before erosion
///   return  by their first fragments
///   throws  Error(cancelled)
[[nodiscard]] std::vector<BodyCluster> bodyClusters(const Solid& solid, const SolidMesh& mesh,
                                                    const Labels& labels,
                                                    const Progress* progress = nullptr);

/// Returns [fragments] the name of each fragment's set: fragments that touch are in one, unless
/// they only lie side by side in different layers.
///   labels  of the solid's blocks, before erosion
[[nodiscard]] std::vector<std::uint32_t> connectedFragments(const Labels& labels);

/// A part of a solid, and its labels.
struct ClusterSolid {
  Solid solid{};    ///< with the mesh of the cluster; its frame and box are those of the whole
  Labels labels{};  ///< with the ids of the whole
};

/// The clusters of a solid as solids of their own.  Keeps references to what it is made of.
class ClusterSolids {
 public:
  ///   solid   with a mesh
  ///   before  the labels before erosion, or the same
  ClusterSolids(const Solid& solid, const Labels& labels, const Labels& before,
                const std::vector<BodyCluster>& clusters);

  /// Returns one, with the leaves that its voxels and cracks need.
  [[nodiscard]] ClusterSolid of(std::size_t cluster) const;

 private:
  [[nodiscard]] std::vector<std::uint32_t> leavesAround(std::size_t cluster) const;
  [[nodiscard]] LeafBlocks blocksOf(std::size_t cluster,
                                    const std::vector<std::uint32_t>& leaves) const;
  [[nodiscard]] Labels labelsOf(std::size_t cluster, const std::vector<std::uint32_t>& leaves,
                                const LeafBlocks& blocks) const;

  const Solid& solid_;
  const Labels& labels_;
  const Labels& before_;
  const std::vector<BodyCluster>& clusters_;
  std::vector<std::uint32_t> ofLabel_;              // [labels] the cluster, or none
  std::vector<std::vector<std::uint32_t>> leaves_;  // [clusters] those with inside voxels
};

}  // namespace sherd
