// A breadth-first search from each seed whose middle is taken.
#include "seed/draw/distinct_middles.h"

#include <array>
#include <map>
#include <optional>
#include <set>

#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

constexpr std::size_t kMostVisited = 200;  // voxels

using Middle = std::array<std::int64_t, 3>;

struct Walled {
  const LeafBlocks& blocks;
  const WallMiddles& walls;

  // Returns the middle at an inside voxel, or nothing outside.
  std::optional<Middle> middleAt(const openvdb::Coord& voxel) const {
    const std::uint32_t leaf = findLeaf(blocks, voxel);
    if (leaf == LeafBlocks::kNone) return std::nullopt;
    const std::size_t index = std::size_t{leaf} * 512 + offsetFromCoord(voxel);
    if (!blocks.isInside(index)) return std::nullopt;
    const glm::i64vec3 at = stepsOf(Seed{voxel}) + glm::i64vec3(walls.wayAt(index));
    return Middle{at.x, at.y, at.z};
  }
};

// Returns the nearest voxel over faces that accepts(voxel, its middle).
template <class Accepts>
std::optional<openvdb::Coord> nearVoxel(const Walled& solid, const openvdb::Coord& from,
                                        const Accepts& accepts) {
  std::vector<openvdb::Coord> queue{from};
  std::set<openvdb::Coord> seen{from};
  for (std::size_t i = 0; i < queue.size() && queue.size() < kMostVisited; ++i) {
    for (int face = 0; face < 6; ++face) {
      openvdb::Coord voxel = queue[i];
      voxel[face / 2] += face % 2 == 0 ? -1 : 1;
      const std::optional<Middle> middle = solid.middleAt(voxel);
      if (!middle || !seen.insert(voxel).second) continue;
      if (accepts(voxel, *middle)) return voxel;
      queue.push_back(voxel);
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<Seed> withDistinctMiddles(std::vector<Seed> seeds, const LeafBlocks& blocks,
                                      const WallMiddles& walls) {
  const Walled solid{blocks, walls};
  std::set<openvdb::Coord> occupied;
  for (const Seed& seed : seeds) occupied.insert(seed.voxel);
  std::map<Middle, std::uint16_t> fragmentAt;
  for (Seed& seed : seeds) {
    std::optional<Middle> own = solid.middleAt(seed.voxel);
    if (!own) continue;
    const auto taken = fragmentAt.find(*own);
    if (taken != fragmentAt.end() && taken->second != seed.fragment) {
      const auto free = nearVoxel(solid, seed.voxel, [&](const auto& voxel, const Middle& middle) {
        return !occupied.contains(voxel) && !fragmentAt.contains(middle);
      });
      if (!free) continue;
      seed.voxel = *free;
      seed.shift = glm::ivec3(0);
      occupied.insert(*free);
      own = solid.middleAt(*free);
    }
    fragmentAt.emplace(*own, seed.fragment);
  }
  return seeds;
}

}  // namespace sherd
