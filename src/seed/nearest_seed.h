// Which fragment's seed is nearest.
#pragma once

#include <sherd/seeds.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// Finds the nearest of some seeds within one part, in whole numbers: a k-d tree for each part.
class NearestSeed {
 public:
  ///   partOfSeed  [seeds] below `parts`; each part has a seed
  NearestSeed(std::span<const Seed> seeds, std::span<const std::uint32_t> partOfSeed,
              std::size_t parts, Metric metric);

  /// The fragment of the nearest seed in that part, ties to the lower id.
  std::uint16_t fragmentAt(const openvdb::Coord& voxel, std::uint32_t part) const;

 private:
  struct Node {
    VoxelBox box;                       // tight about its seeds
    std::uint32_t first = 0, last = 0;  // its seeds
    std::uint32_t right = 0;            // child; the left one follows the node; 0: none
  };
  struct Best;

  void build(std::uint32_t first, std::uint32_t last);
  void search(std::uint32_t node, const openvdb::Coord& voxel, Best& best) const;
  std::int64_t leastOrder(std::uint32_t node, const openvdb::Coord& voxel) const;

  Metric metric_;
  std::vector<Seed> seeds_;  // grouped by part, then by node
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> root_;  // [part]
};

}  // namespace sherd
