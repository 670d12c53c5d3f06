// Both sides of every crack are connected.
#include <algorithm>
#include <map>
#include <queue>
#include <utility>

#include "grow/splits/split_fracture.h"

namespace sherd {
namespace {

// The components of the two sides of a piece, by their roots.
struct Sides {
  struct Component {
    std::uint32_t root;
    std::uint64_t voxels;
  };
  std::vector<Component> kept{}, added{};

  bool isEach() const { return kept.size() == 1 && added.size() == 1; }
};

const Sides::Component& largest(const std::vector<Sides::Component>& components) {
  return *std::max_element(components.begin(), components.end(), [](const auto& a, const auto& b) {
    return a.voxels != b.voxels ? a.voxels < b.voxels : a.root > b.root;
  });
}

// [labels + 1] the sides of pieces that are split in this generation.
std::vector<Sides> sidesOf(const GrowthState& state, const SplitNodes& nodes, std::size_t index,
                           const SplitFracture& fracture, std::span<const std::uint64_t> ofRoot) {
  std::vector<std::uint16_t> parent(fracture.ids.size() + 1, 0);
  for (std::size_t label = 1; label < fracture.planes.size(); ++label) {
    const std::uint16_t added = fracture.planes[label].added;
    if (added == 0) continue;
    parent[label] = static_cast<std::uint16_t>(label);
    parent[added] = static_cast<std::uint16_t>(label);
  }
  std::vector<Sides> sides(fracture.ids.size() + 1);
  const std::size_t begin = index * state.leafCount;
  for (std::size_t item = begin; item < begin + state.leafCount; ++item) {
    const auto [first, last] = nodes.of(item);
    for (std::uint32_t node = first; node < last; ++node) {
      const std::uint16_t label = nodes.label(node);
      if (nodes.root(node) != node || parent[label] == 0) continue;
      Sides& of = sides[parent[label]];
      (label == parent[label] ? of.kept : of.added).push_back({node, ofRoot[node]});
    }
  }
  return sides;
}

// Assigns each component of a piece to one of two connected parts, those of the largest component
// of each side: the others join what they touch first.  Returns the roots of the added part.
//   contacts  of the piece's components, ascending
std::vector<std::uint32_t> addedPart(
    const Sides& sides, std::span<const std::pair<std::uint32_t, std::uint32_t>> contacts) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> touching;
  for (const auto& [a, b] : contacts) {
    touching[a].push_back(b);
    touching[b].push_back(a);
  }
  std::map<std::uint32_t, bool> isAdded{{largest(sides.kept).root, false},
                                        {largest(sides.added).root, true}};
  std::queue<std::uint32_t> next;
  next.push(largest(sides.kept).root);
  next.push(largest(sides.added).root);
  for (; !next.empty(); next.pop()) {
    for (const std::uint32_t other : touching[next.front()]) {
      if (isAdded.emplace(other, isAdded[next.front()]).second) next.push(other);
    }
  }
  std::vector<std::uint32_t> added;
  for (const auto& [root, is] : isAdded) {
    if (is) added.push_back(root);
  }
  return added;
}

}  // namespace

void connectSides(GrowthState& state, const DeviceLabels& labels, SplitNodes& nodes,
                  std::span<const SplitFracture> fractures) {
  std::vector<std::uint64_t> ofRoot(nodes.count(), 0);
  for (std::size_t node = 0; node < nodes.count(); ++node) {
    ofRoot[nodes.root(node)] += nodes.voxels(node);
  }
  std::vector<std::uint16_t> newLabel(nodes.count());  // of roots, then of all nodes
  for (std::size_t node = 0; node < newLabel.size(); ++node) newLabel[node] = nodes.label(node);
  std::vector<std::vector<Sides>> all;
  std::vector<std::uint32_t> piece(nodes.count(), 0);
  bool isAny = false, touch = false;
  for (std::size_t f = 0; f < fractures.size(); ++f) {
    all.push_back(sidesOf(state, nodes, f, fractures[f], ofRoot));
    for (std::size_t label = 1; label < all[f].size(); ++label) {
      Sides& sides = all[f][label];
      if (fractures[f].planes[label].added == 0 || sides.isEach()) continue;
      if (sides.added.empty()) continue;  // the plane missed the piece
      isAny = true;
      if (sides.kept.empty()) {  // the plane missed the piece
        for (const auto& each : sides.added)
          newLabel[each.root] = static_cast<std::uint16_t>(label);
      } else if (!sides.added.empty()) {
        touch = true;
        for (const auto& each : sides.kept) piece[each.root] = static_cast<std::uint32_t>(label);
        for (const auto& each : sides.added) piece[each.root] = static_cast<std::uint32_t>(label);
      }
    }
  }
  if (!isAny) return;
  for (std::size_t node = 0; node < piece.size(); ++node) piece[node] = piece[nodes.root(node)];
  const auto contacts =
      touch ? nodes.contacts(state, piece) : std::vector<std::pair<std::uint32_t, std::uint32_t>>{};
  std::map<std::pair<std::size_t, std::uint32_t>,
           std::vector<std::pair<std::uint32_t, std::uint32_t>>>
      ofPiece;
  std::size_t fracture = 0;
  for (const auto& contact : contacts) {  // ascending, as the nodes of fractures are
    while (fracture + 1 < fractures.size() &&
           contact.first >= nodes.of((fracture + 1) * state.leafCount).first) {
      ++fracture;
    }
    ofPiece[{fracture, piece[contact.first]}].push_back(contact);
  }
  for (const auto& [key, own] : ofPiece) {
    const Sides& sides = all[key.first][key.second];
    const std::uint16_t added = fractures[key.first].planes[key.second].added;
    for (const auto* components : {&sides.kept, &sides.added}) {
      for (const auto& each : *components) {
        newLabel[each.root] = static_cast<std::uint16_t>(key.second);
      }
    }
    for (const std::uint32_t root : addedPart(sides, own)) newLabel[root] = added;
  }
  for (std::size_t node = 0; node < newLabel.size(); ++node) {
    newLabel[node] = newLabel[nodes.root(node)];
  }
  nodes.relabel(state, labels, newLabel);
}

}  // namespace sherd
