// Cells of fragments where these have no voxels.
#include "cut/label_cells.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "base/cancel_flag.h"
#include "cut/site_cut.h"
#include "cut/split_cut.h"

namespace sherd {
namespace {

// Returns the ids of voxels, ascending, without Labels::kEroded.
std::vector<std::uint16_t> fragmentsOf(const Labels& labels) {
  std::vector<bool> isThere(std::size_t{Labels::kEroded} + 1, false);
  for (const std::uint16_t label : labels.fragment) isThere[label] = true;
  std::vector<std::uint16_t> fragments;
  for (std::uint16_t id = 1; id < Labels::kEroded; ++id) {
    if (isThere[id]) fragments.push_back(id);
  }
  return fragments;
}

std::uint16_t nearestSite(const Sites& sites, std::span<const std::uint16_t> fragments,
                          const openvdb::Coord& voxel) {
  const glm::i64vec3 at = sites.stretched(voxel);
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  std::uint16_t nearest = 0;
  for (const std::uint16_t fragment : fragments) {
    for (const Sites::Site& site : sites.of(fragment)) {
      const glm::i64vec3 to = at - site.stretched;
      const std::int64_t order = to.x * to.x + to.y * to.y + to.z * to.z - site.weight;
      if (order >= least) continue;
      least = order;
      nearest = fragment;
    }
  }
  return nearest;
}

// The fragment that no other has a voxel instead of, by the split that parted the two.
std::uint16_t cellOfSplits(const SplitTree& splits, std::span<const std::uint16_t> fragments,
                           const openvdb::Coord& voxel) {
  const SplitTree::Position at{voxel,
                               std::int64_t{64} * glm::i64vec3(voxel.x(), voxel.y(), voxel.z())};
  std::uint16_t cell = fragments.front();
  for (const std::uint16_t other : fragments) {
    const SplitTree::Side* const side = splits.parted(other, cell);
    if (side != nullptr && splits.beyond(*side, at) <= 0) cell = other;
  }
  return cell;
}

}  // namespace

std::vector<std::uint16_t> cellsOf(const Labels& labels, std::span<const openvdb::Coord> voxels,
                                   const Progress* progress) {
  const std::vector<std::uint16_t> fragments = fragmentsOf(labels);
  if (fragments.empty() || labels.walls != nullptr || labels.cracks != nullptr) return {};
  const Sites sites(labels.sites);
  const SplitTree splits(labels.splits);
  if (sites.empty() && splits.empty()) return {};
  std::vector<std::uint16_t> cells(voxels.size());
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
    if (stop.isSet()) return;
    cells[i] = sites.empty() ? cellOfSplits(splits, fragments, voxels[i])
                             : nearestSite(sites, fragments, voxels[i]);
  });
  stop.throwIfSet();
  return cells;
}

}  // namespace sherd
