// Search for the nearest seed.
#pragma once

#include <sherd/seeds.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// Finds the nearest seed of a component in integer arithmetic: one k-d tree per component.
class NearestSeed {
 public:
  ///   componentOfSeed  [seeds] below `components`; each component has a seed
  NearestSeed(std::span<const Seed> seeds, std::span<const std::uint32_t> componentOfSeed,
              std::size_t components, Metric metric);

  /// Returns the fragment of the nearest seed in that component; ties go to the lower id.
  std::uint16_t fragmentAt(const openvdb::Coord& voxel, std::uint32_t component) const;

 private:
  struct Node {
    VoxelBox box;                       // tight box of its seeds
    std::uint32_t first = 0, last = 0;  // its seeds: [first, last)
    std::uint32_t right = 0;  // right child, 0 for a leaf; the left child is the next node
  };
  struct Best;

  void build(std::uint32_t first, std::uint32_t last);
  void search(std::uint32_t node, const openvdb::Coord& voxel, Best& best) const;
  std::int64_t leastOrder(std::uint32_t node, const openvdb::Coord& voxel) const;

  Metric metric_;
  std::vector<Seed> seeds_;  // grouped by component, then by node
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> root_;  // [component]
};

}  // namespace sherd
