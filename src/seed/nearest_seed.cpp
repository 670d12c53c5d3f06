// Search for the nearest seed.
#include "seed/nearest_seed.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace sherd {

struct NearestSeed::Best {
  std::int64_t order = std::numeric_limits<std::int64_t>::max();
  std::uint16_t fragment = 0;
};

NearestSeed::NearestSeed(std::span<const Seed> seeds,
                         std::span<const std::uint32_t> componentOfSeed, std::size_t components,
                         Metric metric)
    : metric_(metric) {
  std::vector<std::uint32_t> order(seeds.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return componentOfSeed[a] < componentOfSeed[b];
  });
  for (const std::uint32_t i : order) seeds_.push_back(seeds[i]);
  std::uint32_t first = 0;
  for (std::uint32_t component = 0; component < components; ++component) {
    std::uint32_t last = first;
    while (last < order.size() && componentOfSeed[order[last]] == component) ++last;
    root_.push_back(static_cast<std::uint32_t>(nodes_.size()));
    build(first, last);
    first = last;
  }
}

void NearestSeed::build(std::uint32_t first, std::uint32_t last) {
  constexpr std::uint32_t kFew = 8;
  Node node{{openvdb::Coord::max(), openvdb::Coord::min()}, first, last, 0};
  for (std::uint32_t i = first; i < last; ++i) {
    node.box.min.minComponent(seeds_[i].voxel);
    node.box.max.maxComponent(seeds_[i].voxel);
  }
  const std::size_t at = nodes_.size();
  nodes_.push_back(node);
  if (last - first <= kFew) return;
  const openvdb::Coord dims = node.box.dims();
  const int axis = dims.x() >= std::max(dims.y(), dims.z()) ? 0 : dims.y() >= dims.z() ? 1 : 2;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(seeds_.begin() + first, seeds_.begin() + middle, seeds_.begin() + last,
                   [axis](const Seed& a, const Seed& b) { return a.voxel[axis] < b.voxel[axis]; });
  build(first, middle);
  nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
  build(middle, last);
}

// Returns a lower bound of the order of the node's seeds.
std::int64_t NearestSeed::leastOrder(std::uint32_t node, const openvdb::Coord& voxel) const {
  const VoxelBox& box = nodes_[node].box;
  const auto gap = [&](int axis) {
    return std::max({std::int64_t{box.min[axis]} - voxel[axis],
                     std::int64_t{voxel[axis]} - box.max[axis], std::int64_t{0}});
  };
  return metricOrder(metric_, gap(0), gap(1), gap(2));
}

void NearestSeed::search(std::uint32_t at, const openvdb::Coord& voxel, Best& best) const {
  const Node& node = nodes_[at];
  if (node.right == 0) {
    for (std::uint32_t i = node.first; i < node.last; ++i) {
      const std::int64_t order = metricOrder(metric_, seeds_[i].voxel, voxel);
      if (order > best.order || (order == best.order && seeds_[i].fragment > best.fragment)) {
        continue;
      }
      best = {order, seeds_[i].fragment};
    }
    return;
  }
  std::uint32_t near = at + 1, far = node.right;
  std::int64_t nearLeast = leastOrder(near, voxel), farLeast = leastOrder(far, voxel);
  if (farLeast < nearLeast) {
    std::swap(near, far);
    std::swap(nearLeast, farLeast);
  }
  // A seed at the same distance may have a lower id.
  if (nearLeast <= best.order) search(near, voxel, best);
  if (farLeast <= best.order) search(far, voxel, best);
}

std::uint16_t NearestSeed::fragmentAt(const openvdb::Coord& voxel, std::uint32_t component) const {
  Best best;
  search(root_[component], voxel, best);
  return best.fragment;
}

}  // namespace sherd
