// The voxels of a mesh whose holes were closed.
#include "surface/closed_solid.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "base/cancel_flag.h"
#include "voxelize/leaf_blocks.h"
#include "voxelize/leaf_masks.h"
#include "voxelize/winding.h"

namespace sherd {
namespace {

using openvdb::Coord;

// Steps over faces that lead to all voxels within kHalfWidthVoxels.
constexpr int kBandSteps = 5;

// The voxels inside a closed mesh that the solid does not have, and the leaves around these.
struct Added {
  std::vector<Coord> voxels;
  std::vector<Coord> origins;  // ascending
};

Added addedVoxels(const Solid& solid, const TriangleMesh& closed, const Progress* progress) {
  TriangleMesh inVoxels{closed.vertices, closed.triangles};
  for (glm::dvec3& v : inVoxels.vertices) v = solid.frame.indexFromWorld(v);
  const Winding winding(inVoxels, Winding::Rule::signedCrossings, progress);
  Added added;
  winding.forEachRun([&](int x, int y, int z, int end, int number) {
    for (; number > 0 && z < end; ++z) {
      const Coord at(x, y, z);
      const std::uint32_t leaf = findLeaf(*solid.blocks, at);
      if (leaf != LeafBlocks::kNone &&
          solid.blocks->isInside(std::size_t{leaf} * 512 + offsetFromCoord(at))) {
        continue;
      }
      added.voxels.push_back(at);
      for (int k = 0; k < 8; ++k) {
        const Coord beside =
            at + Coord(k & 1 ? kBandSteps : -kBandSteps, k & 2 ? kBandSteps : -kBandSteps,
                       k & 4 ? kBandSteps : -kBandSteps);
        added.origins.push_back(beside & ~7);
      }
    }
  });
  std::sort(added.origins.begin(), added.origins.end());
  added.origins.erase(std::unique(added.origins.begin(), added.origins.end()), added.origins.end());
  return added;
}

// Returns the blocks of a solid with more leaves, and moves its labels to them.
LeafBlocks withLeaves(const LeafBlocks& own, const std::vector<Coord>& origins, Labels& labels) {
  LeafBlocks out;
  std::set_union(own.origins.begin(), own.origins.end(), origins.begin(), origins.end(),
                 std::back_inserter(out.origins));
  out.neighbors = leafNeighborTable(out.origins);
  out.inside.assign(out.count() * 8, 0);
  out.exteriorBand.assign(out.count() * 8, 0);
  std::vector<std::uint16_t> fragment(out.count() * 512, 0);
  std::size_t to = 0;
  for (std::size_t from = 0; from < own.count(); ++from, ++to) {
    while (out.origins[to] != own.origins[from]) ++to;
    std::copy_n(&own.inside[from * 8], 8, &out.inside[to * 8]);
    std::copy_n(&own.exteriorBand[from * 8], 8, &out.exteriorBand[to * 8]);
    std::copy_n(&labels.fragment[from * 512], 512, &fragment[to * 512]);
  }
  labels.fragment = std::move(fragment);
  labels.cost.clear();
  return out;
}

std::size_t indexOf(const LeafBlocks& blocks, const Coord& at) {
  const std::uint32_t leaf = findLeaf(blocks, at);
  return leaf == LeafBlocks::kNone ? kNoVoxel : std::size_t{leaf} * 512 + offsetFromCoord(at);
}

// The label of a voxel's first neighbor over a face that has one.
std::uint16_t labelBeside(const LeafBlocks& blocks, const Labels& labels, const Coord& at) {
  for (int side = 0; side < 6; ++side) {
    Coord beside = at;
    beside[side / 2] += side % 2 == 0 ? -1 : 1;
    const std::size_t voxel = indexOf(blocks, beside);
    if (voxel != kNoVoxel && labels.fragment[voxel] != 0) return labels.fragment[voxel];
  }
  return 0;
}

// Labels voxels from what is beside them, layer by layer.  Returns those that are connected to it.
std::vector<Coord> labelAdded(const LeafBlocks& blocks, std::vector<Coord> rest, Labels& labels,
                              const Progress* progress) {
  std::vector<Coord> done;
  std::erase_if(rest, [&](const Coord& at) {
    const bool isLabeled = labels.fragment[indexOf(blocks, at)] != 0;
    if (isLabeled) done.push_back(at);
    return isLabeled;
  });
  while (!rest.empty()) {
    throwIfCancelled(progress);
    std::vector<std::pair<Coord, std::uint16_t>> found;
    std::erase_if(rest, [&](const Coord& at) {
      const std::uint16_t label = labelBeside(blocks, labels, at);
      if (label != 0) found.emplace_back(at, label);
      return label != 0;
    });
    if (found.empty()) break;
    for (const auto& [at, label] : found) {
      labels.fragment[indexOf(blocks, at)] = label;
      done.push_back(at);
    }
  }
  return done;
}

}  // namespace

ClosedSolid closedSolid(const Solid& solid, const Labels& labels, const TriangleMesh& closed,
                        const Progress* progress) {
  ClosedSolid out{solid, labels};
  const Added added = addedVoxels(solid, closed, progress);
  LeafBlocks blocks = withLeaves(*solid.blocks, added.origins, out.labels);
  VoxelMask more(blocks.inside.size(), 0);
  for (const Coord& at : labelAdded(blocks, added.voxels, out.labels, progress)) {
    const std::size_t voxel = indexOf(blocks, at);
    more[voxel / 64] |= std::uint64_t{1} << voxel % 64;
  }
  const VoxelMask all(more.size(), ~std::uint64_t{0});
  const VoxelMask around = grownBySteps(blocks, more, all, kBandSteps);
  for (std::size_t word = 0; word < more.size(); ++word) {
    blocks.inside[word] |= more[word];
    blocks.exteriorBand[word] = (blocks.exteriorBand[word] | around[word]) & ~blocks.inside[word];
  }
  out.solid.blocks = std::make_shared<const LeafBlocks>(std::move(blocks));
  out.labels.blocks = out.solid.blocks;
  return out;
}

}  // namespace sherd
