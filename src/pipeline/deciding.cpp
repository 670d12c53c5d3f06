// Components of two solids of one mesh are matched by where they are.
#include "pipeline/deciding.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <utility>

#include "grow/fields/small_components.h"
#include "voxelize/canonical_solid.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

// Calls visit(voxel) with the first voxel of each component in each leaf.
template <class Visit>
void forEachNode(const LeafBlocks& blocks, const VoxelComponents& components, const Visit& visit) {
  std::vector<std::uint32_t> seen;
  std::size_t leaf = blocks.count();
  blocks.forEachInside([&](std::size_t voxel) {
    if (voxel / 512 != leaf) seen.clear();
    leaf = voxel / 512;
    const std::uint32_t component = components.at(voxel);
    if (std::find(seen.begin(), seen.end(), component) != seen.end()) return;
    seen.push_back(component);
    visit(voxel);
  });
}

// Returns the component of the other solid that is where each of the solid's is, if each is one's
// alone.
std::optional<std::vector<std::uint32_t>> matched(const Solid& solid,
                                                  const VoxelComponents& components,
                                                  const Solid& other,
                                                  const VoxelComponents& ofOther) {
  if (components.count() != ofOther.count()) return {};
  if (components.count() == 1) return std::vector<std::uint32_t>{0};
  const VoxelScale scale = VoxelScale::between(solid, other);
  std::vector<std::map<std::uint32_t, std::size_t>> votes(components.count());
  forEachNode(*solid.blocks, components, [&](std::size_t voxel) {
    const openvdb::Coord at = solid.blocks->voxelAt(voxel);
    const glm::dvec3 there = glm::floor(scale.position({at.x(), at.y(), at.z()}) + 0.5);
    const openvdb::Coord near(static_cast<int>(there.x), static_cast<int>(there.y),
                              static_cast<int>(there.z));
    const std::uint32_t leaf = findLeaf(*other.blocks, near);
    if (leaf == LeafBlocks::kNone) return;
    const std::size_t index = std::size_t{leaf} * 512 + offsetFromCoord(near);
    if (other.blocks->isInside(index)) ++votes[components.at(voxel)][ofOther.at(index)];
  });
  std::vector<std::uint32_t> component;
  std::vector<bool> isTaken(components.count(), false);
  for (const auto& each : votes) {
    const auto most = std::max_element(
        each.begin(), each.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most == each.end() || isTaken[most->first]) return {};
    isTaken[most->first] = true;
    component.push_back(most->first);
  }
  return component;
}

std::optional<OtherSolid> otherOf(const Solid& solid, const VoxelComponents& components,
                                  Device& device, const Progress* progress) {
  const std::shared_ptr<const Solid> canonical = canonicalOf(solid, progress);
  if (!canonical) return {};
  PreparedSolid ready = prepared(*canonical, device);
  auto component = matched(solid, components, ready.solid, ready.components);
  if (!component) return {};
  return OtherSolid{std::move(ready.solid), std::move(ready.components), std::move(ready.walls),
                    std::move(*component)};
}

}  // namespace

const OtherSolid* DecidingSolids::of(const Solid& solid, const VoxelComponents& components,
                                     Device& device, const Progress* progress) {
  const std::lock_guard lock(finding_);
  if (!isFound_) {
    tbb::this_task_arena::isolate([&] { found_ = otherOf(solid, components, device, progress); });
    isFound_ = true;
  }
  return found_ ? &*found_ : nullptr;
}

}  // namespace sherd
