// Host side of kernels/split.cl: measuring and labeling nodes.
#include "grow/splits/split_nodes.h"

#include <algorithm>

namespace sherd {

SplitNodes::SplitNodes(GrowthState& state, const DeviceLabels& labels, NodeComponents found)
    : found_(std::move(found)) {
  const DeviceBuffer sums = makeBuffer<std::uint16_t>(state.device, found_.nodes * kSums);
  state.run("split_measure", state.items, state.inside, state.leafCount, state.items, labels.owner,
            labels.tag, labels.second, found_.localNode, found_.firstNode, found_.nodeCount, sums);
  sums_ = downloaded<std::uint16_t>(state.device, sums, found_.nodes * kSums);
}

VoxelSums SplitNodes::sums(std::size_t node) const {
  const std::uint16_t* const from = &sums_[node * kSums];
  VoxelSums out;
  out.count = from[0];
  for (std::size_t i = 0; i < 3; ++i) out.sum[i] = from[1 + i];
  for (std::size_t i = 0; i < 6; ++i) out.squares[i] = from[4 + i];
  return out;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> SplitNodes::contacts(
    GrowthState& state, std::span<const std::uint32_t> piece) const {
  const DeviceBuffer pieces = uploadBuffer<std::uint32_t>(state.device, piece);
  std::uint32_t capacity = 1 << 14;
  for (;;) {
    const DeviceBuffer count = state.filled<std::uint32_t>(1, 0);
    const DeviceBuffer pairs = makeBuffer<std::uint32_t>(state.device, 2 * std::size_t{capacity});
    state.run("split_contacts", state.items, state.inside, state.neighbor, state.leafCount,
              state.items, found_.localNode, found_.firstNode, found_.nodeCount, found_.root,
              pieces, capacity, count, pairs);
    const std::uint32_t found = downloaded<std::uint32_t>(state.device, count, 1).front();
    if (found > capacity) {
      capacity = found;
      continue;
    }
    const auto flat = downloaded<std::uint32_t>(state.device, pairs, 2 * std::size_t{found});
    std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
    for (std::size_t i = 0; i < flat.size(); i += 2) out.emplace_back(flat[i], flat[i + 1]);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }
}

void SplitNodes::relabel(GrowthState& state, const DeviceLabels& labels,
                         std::span<const std::uint16_t> label) {
  std::vector<std::uint32_t> changed(state.items, 0);
  for (std::size_t item = 0; item < changed.size(); ++item) {
    const auto [first, last] = of(item);
    for (std::uint32_t node = first; node < last; ++node) {
      changed[item] |= label[node] != this->label(node) ? 1u : 0u;
      sums_[node * kSums + 10] = label[node];
    }
  }
  state.run(
      "split_relabel", state.items, state.inside, state.leafCount, state.items, found_.localNode,
      found_.firstNode, found_.nodeCount, uploadBuffer<std::uint32_t>(state.device, changed),
      uploadBuffer<std::uint16_t>(state.device, label), labels.owner, labels.tag, labels.second);
  state.device.finish();  // the local buffers are released here
}

std::vector<std::uint16_t> SplitNodes::nearestVoxels(GrowthState& state,
                                                     std::span<const Target> targets) const {
  std::vector<std::uint32_t> item, node;
  std::vector<Int4> position;
  for (const Target& target : targets) {
    item.push_back(target.item);
    node.push_back(target.node);
    position.push_back({target.position.x, target.position.y, target.position.z, 0});
  }
  const DeviceBuffer offset = makeBuffer<std::uint16_t>(state.device, targets.size());
  const auto count = static_cast<std::uint32_t>(targets.size());
  state.run("split_nearest", count, state.inside, state.leafCount, found_.localNode,
            found_.firstNode, found_.nodeCount, uploadBuffer<std::uint32_t>(state.device, item),
            uploadBuffer<std::uint32_t>(state.device, node),
            uploadBuffer<Int4>(state.device, position), count, offset);
  return downloaded<std::uint16_t>(state.device, offset, targets.size());
}

}  // namespace sherd
