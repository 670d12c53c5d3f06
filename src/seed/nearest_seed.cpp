// Search for the nearest seed.
#include "seed/nearest_seed.h"

#include <algorithm>
#include <glm/common.hpp>
#include <limits>

namespace sherd {

struct NearestSeed::Best {
  double order = std::numeric_limits<double>::max();
  std::uint16_t fragment = 0;
};

NearestSeed::NearestSeed(std::vector<Site> sites, std::size_t components, Metric metric)
    : metric_(metric), sites_(std::move(sites)) {
  std::stable_sort(sites_.begin(), sites_.end(),
                   [](const Site& a, const Site& b) { return a.component < b.component; });
  std::uint32_t first = 0;
  for (std::uint32_t component = 0; component < components; ++component) {
    std::uint32_t last = first;
    while (last < sites_.size() && sites_[last].component == component) ++last;
    root_.push_back(static_cast<std::uint32_t>(nodes_.size()));
    build(first, last);
    first = last;
  }
}

void NearestSeed::build(std::uint32_t first, std::uint32_t last) {
  constexpr std::uint32_t kFew = 8;
  Node node{glm::i64vec3(std::numeric_limits<std::int64_t>::max() / 4),
            glm::i64vec3(std::numeric_limits<std::int64_t>::min() / 4), first, last};
  for (std::uint32_t i = first; i < last; ++i) {
    node.mostScale = std::max(node.mostScale, sites_[i].scale);
    node.min = glm::min(node.min, sites_[i].at);
    node.max = glm::max(node.max, sites_[i].at);
  }
  const std::size_t at = nodes_.size();
  nodes_.push_back(node);
  if (last - first <= kFew) return;
  const glm::i64vec3 dims = node.max - node.min;
  const int axis = dims.x >= std::max(dims.y, dims.z) ? 0 : dims.y >= dims.z ? 1 : 2;
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(sites_.begin() + first, sites_.begin() + middle, sites_.begin() + last,
                   [axis](const Site& a, const Site& b) { return a.at[axis] < b.at[axis]; });
  build(first, middle);
  nodes_[at].right = static_cast<std::uint32_t>(nodes_.size());
  build(middle, last);
}

// Returns a lower bound of the order of the node's sites.
double NearestSeed::leastOrder(std::uint32_t node, const glm::i64vec3& point) const {
  const glm::i64vec3 &min = nodes_[node].min, &max = nodes_[node].max;
  const auto gap = [&](int axis) {
    return std::max({min[axis] - point[axis], point[axis] - max[axis], std::int64_t{0}});
  };
  return static_cast<double>(metricOrder(metric_, gap(0), gap(1), gap(2))) / nodes_[node].mostScale;
}

void NearestSeed::search(std::uint32_t at, const glm::i64vec3& point, Best& best) const {
  const Node& node = nodes_[at];
  if (node.right == 0) {
    for (std::uint32_t i = node.first; i < node.last; ++i) {
      const glm::i64vec3 apart = sites_[i].at - point;
      const double order =
          static_cast<double>(metricOrder(metric_, apart.x, apart.y, apart.z)) / sites_[i].scale;
      if (order > best.order || (order == best.order && sites_[i].fragment > best.fragment)) {
        continue;
      }
      best = {order, sites_[i].fragment};
    }
    return;
  }
  std::uint32_t near = at + 1, far = node.right;
  double nearLeast = leastOrder(near, point), farLeast = leastOrder(far, point);
  if (farLeast < nearLeast) {
    std::swap(near, far);
    std::swap(nearLeast, farLeast);
  }
  // A seed at the same distance may have a lower id.
  if (nearLeast <= best.order) search(near, point, best);
  if (farLeast <= best.order) search(far, point, best);
}

std::uint16_t NearestSeed::fragmentAt(const glm::i64vec3& point, std::uint32_t component) const {
  Best best;
  search(root_[component], point, best);
  return best.fragment;
}

}  // namespace sherd
