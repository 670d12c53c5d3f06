// Reduces the labels to two: the fragment, and all else as if it were worn off.
#include "surface/lone_mesh.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "surface/interface_mesh.h"

namespace sherd {
namespace {

// The cut as the fragment sees it, and the same from the other side.
CutLeaf bothSides(const CutLeaf& cut, std::uint16_t fragment) {
  CutLeaf both{{1, Labels::kWorn}, {}};
  if (cut.distance.empty()) return both;
  const auto at = std::lower_bound(cut.fragments.begin(), cut.fragments.end(), fragment);
  const auto own = cut.distance.begin() + (at - cut.fragments.begin()) * 512;
  both.distance.assign(own, own + 512);
  for (std::size_t v = 0; v < 512; ++v) both.distance.push_back(-both.distance[v]);
  return both;
}

}  // namespace

LabelledMesh meshOfOne(const Solid& solid, const Labels& labels, const Cut& cut,
                       std::uint16_t fragment, std::span<const std::uint32_t> leaves) {
  Solid part;
  part.frame = solid.frame;
  part.distance = solid.distance;
  Labels two;
  Cut own;
  own.stairs.resize(std::size_t{Labels::kWorn} + 1);
  own.stairs[1] = cut.stairs[fragment];
  for (const std::uint32_t leaf : leaves) {
    const auto from = static_cast<std::ptrdiff_t>(leaf);
    const auto inside = solid.blocks.inside.begin() + from * 8;
    part.blocks.origins.push_back(solid.blocks.origins[leaf]);
    part.blocks.inside.insert(part.blocks.inside.end(), inside, inside + 8);
    std::transform(labels.fragment.begin() + from * 512, labels.fragment.begin() + (from + 1) * 512,
                   std::back_inserter(two.fragment), [&](std::uint16_t label) {
                     return label == fragment ? std::uint16_t{1} : Labels::kWorn;
                   });
    const bool isWhole = cut.index[leaf] == Cut::kWhole;
    own.only.push_back(isWhole ? 1 : 0);
    own.index.push_back(isWhole ? Cut::kWhole : static_cast<std::uint32_t>(own.leaves.size()));
    if (!isWhole) own.leaves.push_back(bothSides(cut.leaves[cut.index[leaf]], fragment));
  }
  const std::vector<LeafRound> rounds = leavesRound(part.blocks.origins);
  return InterfaceMeshes(part, two, own, rounds, 1).meshOf(1);
}

}  // namespace sherd
