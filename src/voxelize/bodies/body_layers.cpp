// Bodies of a mesh that stay apart however near they are.
#include "voxelize/bodies/body_layers.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/cancel_flag.h"
#include "voxelize/bodies/disjoint_bodies.h"
#include "voxelize/leaves/leaf_masks.h"
#include "voxelize/leaves/voxel_owners.h"

namespace sherd {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

void set(VoxelMask& mask, std::size_t voxel) {
  mask[voxel / 64] |= std::uint64_t{1} << (voxel % 64);
}

// Returns pairs of bodies, both ways round, ascending.
//   components  pairs of these
Pairs pairsOf(std::span<const std::array<std::uint32_t, 2>> components,
              const std::vector<std::uint32_t>& body) {
  Pairs pairs;
  for (const auto& [c, d] : components) {
    const std::uint32_t a = body[c], b = body[d];
    if (a == b) continue;
    pairs.push_back({a, b});
    pairs.push_back({b, a});
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

// Returns the number of bodies with voxels beside those of others.
std::size_t bodiesBeside(const std::vector<std::array<std::uint32_t, 2>>& components,
                         const std::vector<std::uint32_t>& body) {
  const Pairs pairs = pairsOf(components, body);
  std::size_t bodies = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    bodies += i == 0 || pairs[i].first != pairs[i - 1].first ? 1 : 0;
  }
  return bodies;
}

// The voxels of one layer, by flooding.
class LayerFlood {
 public:
  LayerFlood(const LeafBlocks& blocks, VoxelMask& own, const VoxelMask& others)
      : blocks_(blocks), own_(own), others_(others), isQueued_(blocks.count(), false) {}

  void add(std::size_t leaf) {
    if (isQueued_[leaf]) return;
    isQueued_[leaf] = true;
    queue_.push_back(static_cast<std::uint32_t>(leaf));
  }

  void run(const Progress* progress) {
    for (std::size_t steps = 0; !queue_.empty(); ++steps) {
      if (steps % 4096 == 0) throwIfCancelled(progress);
      const std::uint32_t leaf = queue_.back();
      queue_.pop_back();
      isQueued_[leaf] = false;
      if (!grow(leaf)) continue;
      for (std::size_t k = 0; k < 6; ++k) {
        const std::uint32_t next = blocks_.neighbors[std::size_t{leaf} * 6 + k];
        if (next != LeafBlocks::kNone && takes(next, leaf, k ^ 1)) add(next);
      }
    }
  }

 private:
  [[nodiscard]] std::uint64_t open(std::size_t word) const {
    return blocks_.inside[word] & ~others_[word];
  }

  [[nodiscard]] bool takes(std::uint32_t leaf, std::uint32_t from, std::size_t k) const {
    std::uint64_t any = 0;
    for (std::size_t x = 0; x < 8; ++x) {
      const std::size_t word = std::size_t{leaf} * 8 + x;
      any |= besideFace(own_, from, k, x) & open(word) & ~own_[word];
    }
    return any != 0;
  }

  // Takes what the leaf's voxels and those beside it reach within it.  Always the case for a leaf
  // that was added with voxels of its own; returns whether its neighbors have to be looked at.
  bool grow(std::uint32_t leaf) {
    std::uint64_t* const own = &own_[std::size_t{leaf} * 8];
    for (std::size_t k = 0; k < 6; ++k) {
      const std::uint32_t beside = blocks_.neighbors[std::size_t{leaf} * 6 + k];
      if (beside == LeafBlocks::kNone) continue;
      for (std::size_t x = 0; x < 8; ++x) {
        own[x] |= besideFace(own_, beside, k, x) & open(std::size_t{leaf} * 8 + x);
      }
    }
    std::uint64_t any = 0;
    for (bool isChanged = true; isChanged;) {
      isChanged = false;
      for (std::size_t x = 0; x < 8; ++x) {
        const std::uint64_t reached = withBeside(own, x) & open(std::size_t{leaf} * 8 + x);
        any |= reached;
        if ((reached & ~own[x]) == 0) continue;
        own[x] |= reached;
        isChanged = true;
      }
    }
    return any != 0;
  }

  const LeafBlocks& blocks_;
  VoxelMask& own_;
  const VoxelMask& others_;
  std::vector<bool> isQueued_;
  std::vector<std::uint32_t> queue_{};
};

// What the voxels of a layer are found from.
struct LayerSource {
  const LeafBlocks& blocks;
  const VoxelOwners& owners;
  std::span<const std::uint16_t> layer;  // [components]
  std::span<const std::uint8_t> isNear;  // [components] whether its body comes near others
};

// Returns the voxels of a layer: those next to the surfaces of its bodies, and all that are
// connected with them without passing voxels next to those of other layers.
VoxelMask voxelsOf(std::uint16_t layer, const LayerSource& from, const Progress* progress) {
  const LeafBlocks& blocks = from.blocks;
  VoxelMask own(blocks.inside.size(), 0), others(blocks.inside.size(), 0);
  LayerFlood flood(blocks, own, others);
  from.owners.forEach([&](std::size_t voxel, std::uint32_t component) {
    if (from.isNear[component] == 0) return;
    if (from.layer[component] != layer) {
      set(others, voxel);
    } else {
      set(own, voxel);
      flood.add(voxel / 512);
    }
  });
  flood.run(progress);
  // Parts of a body that are connected only through walls thinner than voxels.
  const std::vector<std::uint32_t>& near = from.owners.nearLeaves();
  for (std::size_t leaf = 0; leaf < near.size(); ++leaf) {
    const std::uint32_t component = near[leaf];
    if (component == VoxelOwners::kNone || component == VoxelOwners::kSeveral) continue;
    if (from.isNear[component] == 0 || from.layer[component] != layer) continue;
    for (std::size_t v = leaf * 512; v < leaf * 512 + 512; ++v) {
      if (!blocks.isInside(v) || (own[v / 64] >> (v % 64) & 1) != 0) continue;
      if (from.owners.ownerOf(v) != component) continue;
      set(own, v);
      flood.add(leaf);
    }
  }
  flood.run(progress);
  return own;
}

}  // namespace

std::vector<std::uint16_t> layersApart(
    std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs, std::size_t bodies,
    std::uint32_t spread) {
  std::vector<std::uint16_t> layer;
  for (std::uint32_t own = 0; own < bodies; ++own) {
    layer.push_back(static_cast<std::uint16_t>(own % spread));
  }
  for (auto from = pairs.begin(); from != pairs.end();) {
    const std::uint32_t own = from->first;
    std::vector<std::uint16_t> taken;
    for (; from != pairs.end() && from->first == own; ++from) {
      if (from->second < own) taken.push_back(layer[from->second]);
    }
    std::sort(taken.begin(), taken.end());
    const auto isTaken = [&](std::uint32_t each) {
      return std::binary_search(taken.begin(), taken.end(), each);
    };
    std::uint32_t k = 0;
    const auto candidate = [&] { return k < spread ? (own + k) % spread : k; };
    while (isTaken(candidate())) ++k;
    layer[own] = static_cast<std::uint16_t>(candidate());
  }
  return layer;
}

BodyLayers bodyLayers(const LeafBlocks& blocks, const SearchedMesh& mesh,
                      std::span<const glm::dvec3> vertices, const Progress* progress) {
  const MeshComponents components = meshComponents(mesh.mesh);
  if (components.count < 2) return {};
  const VoxelOwners owners(blocks, *mesh.tree, components, progress);
  if (owners.areTooMany()) return {.areJoined = true};
  if (owners.nearPairs().empty()) return {};
  std::vector<std::uint8_t> isNear(components.count, 0);
  for (const auto& [a, b] : owners.nearPairs()) isNear[a] = isNear[b] = 1;
  const std::vector<std::uint32_t> body =
      disjointBodies(vertices, mesh.mesh, components, isNear, progress);
  const Pairs pairs = pairsOf(owners.nearPairs(), body);
  if (pairs.empty()) return {};
  const std::vector<std::uint16_t> layerOfBody = layersApart(pairs, components.count);
  std::vector<std::uint8_t> isBodyNear(components.count, 0);
  for (const auto& [a, b] : pairs) isBodyNear[a] = 1;
  BodyLayers out;
  out.bodies = bodiesBeside(owners.neighbors(), body);
  std::vector<std::uint16_t> layer;
  for (std::uint32_t c = 0; c < components.count; ++c) {
    layer.push_back(layerOfBody[body[c]]);
    isNear[c] = isBodyNear[body[c]];
  }
  for (const std::uint32_t c : components.ofTriangle) out.ofTriangle.push_back(layer[c]);
  const std::uint16_t highest = *std::max_element(layer.begin(), layer.end());
  for (std::uint16_t each = 1; each <= highest; ++each) {
    out.voxels.push_back(voxelsOf(each, {blocks, owners, layer, isNear}, progress));
  }
  return out;
}

}  // namespace sherd
