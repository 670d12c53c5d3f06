// Clusters of bodies as solids of their own.
#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "remesh/vertex_numbers.h"
#include "surface/exact/body_clusters.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/leaves/leaf_masks.h"

namespace sherd {
namespace {

constexpr auto kNoCluster = std::numeric_limits<std::uint32_t>::max();

// Some triangles of a mesh, with their vertices alone.
SolidMesh clusterMesh(const SolidMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  std::vector<std::uint32_t> used;
  for (const std::uint32_t t : triangles) {
    const glm::uvec3& c = mesh.mesh.triangles[t];
    used.insert(used.end(), {c.x, c.y, c.z});
  }
  const VertexNumbers numbers(std::move(used), mesh.mesh.vertices.size());
  SolidMesh own;
  for (const std::uint32_t v : numbers.vertices()) {
    own.mesh.vertices.push_back(mesh.mesh.vertices[v]);
  }
  for (const std::uint32_t t : triangles) {
    const glm::uvec3& c = mesh.mesh.triangles[t];
    own.mesh.triangles.emplace_back(numbers.of(c.x), numbers.of(c.y), numbers.of(c.z));
    own.source.push_back(mesh.source[t]);
    if (!mesh.layer.empty()) own.layer.push_back(mesh.layer[t]);
  }
  return own;
}

// Numbers the layers that a mesh has from 0, and leaves out those of one layer alone.
//   return  [layers] those that they were before
std::vector<std::uint16_t> renumberLayers(SolidMesh& mesh) {
  std::vector<std::uint16_t> used = mesh.layer;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (std::uint16_t& layer : mesh.layer) {
    layer = static_cast<std::uint16_t>(std::lower_bound(used.begin(), used.end(), layer) -
                                       used.begin());
  }
  if (used.size() < 2) mesh.layer.clear();
  return used;
}

}  // namespace

ClusterSolids::ClusterSolids(const Solid& solid, const Labels& labels, const Labels& before,
                             const std::vector<BodyCluster>& clusters)
    : solid_(solid),
      labels_(labels),
      before_(before),
      clusters_(clusters),
      ofLabel_(std::size_t{Labels::kEroded} + 1, kNoCluster),
      leaves_(clusters.size()) {
  for (std::uint32_t c = 0; c < clusters.size(); ++c) {
    for (const std::uint16_t label : clusters[c].fragments) ofLabel_[label] = c;
  }
  solid.blocks->forEachInside([&](std::size_t voxel) {
    const std::uint32_t cluster = ofLabel_[before.fragment[voxel]];
    if (cluster == kNoCluster) return;
    const auto leaf = static_cast<std::uint32_t>(voxel / 512);
    if (leaves_[cluster].empty() || leaves_[cluster].back() != leaf) {
      leaves_[cluster].push_back(leaf);
    }
  });
}

std::vector<std::uint32_t> ClusterSolids::leavesAround(std::size_t cluster) const {
  std::vector<std::uint32_t> leaves = leaves_[cluster];
  for (std::size_t axis = 0; axis < 3; ++axis) {  // one after the other: all 26
    const std::size_t count = leaves.size();
    for (std::size_t i = 0; i < count; ++i) {
      for (const std::size_t side : {2 * axis, 2 * axis + 1}) {
        const std::uint32_t next = solid_.blocks->neighbors[std::size_t{leaves[i]} * 6 + side];
        if (next != LeafBlocks::kNone) leaves.push_back(next);
      }
    }
  }
  std::sort(leaves.begin(), leaves.end());
  leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
  return leaves;
}

LeafBlocks ClusterSolids::blocksOf(std::size_t cluster,
                                   const std::vector<std::uint32_t>& leaves) const {
  const LeafBlocks& all = *solid_.blocks;
  LeafBlocks own;
  VoxelMask active;
  for (const std::uint32_t leaf : leaves) {
    own.origins.push_back(all.origins[leaf]);
    for (std::size_t word = std::size_t{leaf} * 8; word < std::size_t{leaf} * 8 + 8; ++word) {
      std::uint64_t inside = 0;
      for (std::size_t bit = 0; bit < 64; ++bit) {
        const bool isOwn = ofLabel_[before_.fragment[word * 64 + bit]] == cluster;
        inside |= std::uint64_t{isOwn} << bit;
      }
      own.inside.push_back(inside & all.inside[word]);
      active.push_back(all.inside[word] | all.exteriorBand[word]);
    }
  }
  own.neighbors = leafNeighborTable(own.origins);
  own.exteriorBand = grownBySteps(own, own.inside, active, kBandSteps);
  for (std::size_t word = 0; word < own.inside.size(); ++word) {
    own.exteriorBand[word] &= ~own.inside[word];
  }
  return own;
}

Labels ClusterSolids::labelsOf(std::size_t cluster, const std::vector<std::uint32_t>& leaves,
                               const LeafBlocks& blocks) const {
  Labels own{.fragmentCount = labels_.fragmentCount,
             .sites = labels_.sites,
             .splits = labels_.splits,
             .cracks = labels_.cracks,
             .walls = labels_.walls};
  own.fragment.assign(leaves.size() * 512, 0);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    for (std::size_t v = 0; v < 512; ++v) {
      const std::size_t from = std::size_t{leaves[i]} * 512 + v, to = i * 512 + v;
      const std::uint64_t active = blocks.inside[to / 64] | blocks.exteriorBand[to / 64];
      if ((active >> (to % 64) & 1) == 0 || ofLabel_[before_.fragment[from]] != cluster) continue;
      own.fragment[to] = labels_.fragment[from];
    }
  }
  return own;
}

ClusterSolid ClusterSolids::of(std::size_t cluster) const {
  const std::vector<std::uint32_t> leaves = leavesAround(cluster);
  SolidMesh mesh = clusterMesh(*solid_.mesh, clusters_[cluster].triangles);
  const std::vector<std::uint16_t> layers = renumberLayers(mesh);
  LeafBlocks blocks = blocksOf(cluster, leaves);
  for (std::size_t i = 1; i < layers.size(); ++i) {
    VoxelMask own;
    for (const std::uint32_t leaf : leaves) {
      for (std::size_t word = std::size_t{leaf} * 8; word < std::size_t{leaf} * 8 + 8; ++word) {
        own.push_back(insideOfLayer(*solid_.blocks, layers[i], word) & blocks.inside[own.size()]);
      }
    }
    blocks.layers.push_back(std::move(own));
  }
  ClusterSolid out{.labels = labelsOf(cluster, leaves, blocks)};
  Solid& part = out.solid;
  part = solid_;
  part.voxels = blocks.insideVoxels();
  part.smallComponents = 0;  // known of the whole
  part.region = nullptr;
  part.mesh = std::make_shared<const SolidMesh>(std::move(mesh));
  part.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  out.labels.blocks = part.blocks;
  return out;
}

}  // namespace sherd
