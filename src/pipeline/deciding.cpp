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
#include "voxelize/distance.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/level_set_mesh.h"
#include "voxelize/region.h"
#include "voxelize/voxelize.h"

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

std::optional<OtherSolid> otherSolid(const Solid& solid, const VoxelComponents& components,
                                     Solid canonical, Device& device) {
  PreparedSolid ready = prepared(std::move(canonical), device);
  auto component = matched(solid, components, ready.solid, ready.components);
  if (!component) return {};
  return OtherSolid{std::move(ready.solid), std::move(ready.components), std::move(ready.walls),
                    std::move(*component)};
}

// Returns the solid of a mesh in a grid with the low corner of another's.
Solid solidIn(const TriangleMesh& mesh, const GridFrame& like, double voxelSize,
              const Progress* progress) {
  Solid out;
  out.frame = {like.origin + 0.5 * (voxelSize - like.voxelSize), voxelSize};
  out.distance = levelSetIn(mesh, out.frame, progress);
  out.blocks = std::make_shared<const LeafBlocks>(leafBlocks(*out.distance));
  out.report.fill = Fill::winding;
  measureVoxels(out);
  return out;
}

// The same for a solid without a mesh, from its level set.
std::optional<OtherSolid> otherOfLevelSet(const Solid& solid, const VoxelComponents& components,
                                          Device& device, const Progress* progress) {
  const double longest = solid.box.longestSide();
  if (solid.region || !solid.distance || longest <= 1.25 * CanonicalSolid::kResolution) return {};
  return decidingSolid(solid, components, meshInWorld(*solid.distance),
                       longest * solid.frame.voxelSize, device, progress);
}

std::optional<OtherSolid> otherOf(const Solid& solid, const VoxelComponents& components,
                                  Device& device, const Progress* progress) {
  if (const std::shared_ptr<const Solid> canonical = canonicalOf(solid, progress)) {
    return otherSolid(solid, components, *canonical, device);
  }
  return otherOfLevelSet(solid, components, device, progress);
}

}  // namespace

std::optional<OtherSolid> decidingSolid(const Solid& solid, const VoxelComponents& components,
                                        const TriangleMesh& mesh, double side, Device& device,
                                        const Progress* progress) {
  // Of the volume: walls that voxels do not resolve lose more.
  constexpr double kVolumesAgree = 0.03;
  const double expected = volume(mesh);
  for (const int resolution : {CanonicalSolid::kResolution, CanonicalSolid::kMostResolution}) {
    const double voxelSize = side / resolution;
    Solid own = solidIn(mesh, solid.frame, voxelSize, progress);
    const double found = static_cast<double>(own.voxels) * voxelSize * voxelSize * voxelSize;
    if (std::abs(found - expected) > kVolumesAgree * expected) continue;
    if (auto other = otherSolid(solid, components, std::move(own), device)) {
      other->side = side;
      return other;
    }
  }
  return {};
}

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
