// The generations of splits, on the device.
#include "grow/splits/split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "base/cancel_flag.h"
#include "grow/fields/ways_on_device.h"
#include "grow/splits/split_fracture.h"
#include "voxelize/leaves/leaf_blocks.h"

namespace sherd {
namespace {

// The sums of nodes by label.
std::vector<VoxelSums> sumsOfLabels(const GrowthState& state, const SplitNodes& nodes,
                                    std::size_t fracture, std::size_t labels,
                                    std::span<const glm::ivec3> low) {
  std::vector<VoxelSums> sums(labels + 1);
  for (std::size_t leaf = 0; leaf < state.leafCount; ++leaf) {
    const auto [first, last] = nodes.of(fracture * state.leafCount + leaf);
    for (std::size_t node = first; node < last; ++node) {
      sums[nodes.label(node)].add(nodes.sums(node), low[leaf]);
    }
  }
  return sums;
}

// The voxels of nodes times the densities of their leaves, by label.
std::vector<double> massOfLabels(const GrowthState& state, const SplitNodes& nodes,
                                 std::size_t fracture, std::span<const VoxelSums> sums,
                                 std::span<const double> densities) {
  std::vector<double> mass(sums.size(), 0.0);
  if (densities.empty()) {
    for (std::size_t i = 0; i < mass.size(); ++i) mass[i] = static_cast<double>(sums[i].count);
    return mass;
  }
  for (std::size_t leaf = 0; leaf < state.leafCount; ++leaf) {
    const auto [first, last] = nodes.of(fracture * state.leafCount + leaf);
    for (std::size_t node = first; node < last; ++node) {
      mass[nodes.label(node)] += nodes.voxels(node) * densities[leaf];
    }
  }
  return mass;
}

// Splits the voxels of all fractures by their planes, on the device.
void splitByPlanes(GrowthState& state, const DeviceLabels& labels, const DeviceBuffer& origins,
                   const WaysOnDevice& ways, std::span<const SplitFracture> fractures) {
  std::vector<Int4> plane, center;
  std::vector<std::int64_t> offset;
  std::vector<std::uint32_t> first;
  for (const SplitFracture& fracture : fractures) {
    first.push_back(static_cast<std::uint32_t>(plane.size()));
    for (const SplitPlane& each : fracture.planes) {
      plane.push_back({each.normal.x, each.normal.y, each.normal.z, each.added});
      center.push_back({each.center.x, each.center.y, each.center.z,
                        each.isSphere       ? 1
                        : each.ignoresWalls ? 2
                                            : 0});
      offset.push_back(each.offset);
    }
  }
  state.run("split_labels", state.items, state.inside, origins, state.leafCount, state.items,
            ways.way, ways.reach, ways.isUsed, uploadBuffer<std::uint32_t>(state.device, first),
            uploadBuffer<Int4>(state.device, plane), uploadBuffer<Int4>(state.device, center),
            uploadBuffer<std::int64_t>(state.device, offset), labels.owner, labels.tag,
            labels.second);
}

// Gives every piece that can be split a second label; those without voxels on one side of a given
// crack stay whole.
void splitAll(SplitFracture& fracture, std::size_t crack) {
  fracture.planes.assign(fracture.ids.size() + 1, SplitPlane{});
  for (const SplitPiece& piece : fracture.pieces) {
    if (!piece.isSplit()) continue;
    if (piece.isGiven) {
      const Split& next = fracture.given.next(piece.label)->split;
      const bool isThis = !next.isSphere && next.normal == glm::ivec3(0) &&
                          next.offset == static_cast<std::int64_t>(crack);
      if (isThis) fracture.planes[piece.label] = {glm::ivec3(0), next.offset, next.added};
      continue;
    }
    fracture.planes[piece.label] = {glm::ivec3(0), static_cast<std::int64_t>(crack),
                                    fracture.nextId()};
  }
}

// Splits the voxels of all fractures by the sides of a given crack, on the device.
void splitBySides(GrowthState& state, const DeviceLabels& labels,
                  std::span<const std::uint64_t> positive,
                  std::span<const SplitFracture> fractures) {
  std::vector<std::uint32_t> first, added;
  for (const SplitFracture& fracture : fractures) {
    first.push_back(static_cast<std::uint32_t>(added.size()));
    for (const SplitPlane& each : fracture.planes) added.push_back(each.added);
  }
  state.run("split_by_sides", state.items, state.inside,
            uploadBuffer<std::uint64_t>(state.device, positive), state.leafCount, state.items,
            uploadBuffer<std::uint32_t>(state.device, first),
            uploadBuffer<std::uint32_t>(state.device, added), labels.owner, labels.tag,
            labels.second);
}

// Returns labels of the components, each by the piece of its number.
DeviceLabels componentLabels(GrowthState& state, const VoxelComponents& components,
                             std::span<const SplitFracture> fractures) {
  const LeafBlocks& blocks = state.blocks;
  std::vector<std::uint32_t> ofLeaf(state.leafCount, 0);  // component + 1, or mixed
  std::vector<std::uint32_t> mixedLeaves;
  for (std::uint32_t leaf = 0; leaf < state.leafCount; ++leaf) {
    for (std::size_t v = std::size_t{leaf} * 512; v < std::size_t{leaf + 1} * 512; ++v) {
      if (!blocks.isInside(v)) continue;
      const std::uint32_t own = components.at(v) + 1;
      if (ofLeaf[leaf] != 0 && ofLeaf[leaf] != own) {
        ofLeaf[leaf] = SHERD_TAG_MIXED;
        break;
      }
      ofLeaf[leaf] = own;
      if (components.count() == 1) break;
    }
  }
  std::vector<std::uint32_t> tags;
  for (const SplitFracture& fracture : fractures) {
    for (const std::uint32_t own : ofLeaf) {
      const bool isOne = own != 0 && own != SHERD_TAG_MIXED;
      tags.push_back(isOne ? fracture.pieces[own - 1].label : own);
    }
  }
  DeviceLabels labels = makeLabels(state);
  if (std::find(ofLeaf.begin(), ofLeaf.end(), SHERD_TAG_MIXED) != ofLeaf.end()) {
    std::vector<std::uint16_t> owner(state.voxels(), 0);
    for (std::size_t f = 0; f < fractures.size(); ++f) {
      blocks.forEachInside([&](std::size_t v) {
        owner[f * state.leafCount * 512 + v] = fractures[f].pieces[components.at(v)].label;
      });
    }
    labels.owner = uploadBuffer<std::uint16_t>(state.device, owner);
  }
  labels.tag = uploadBuffer<std::uint32_t>(state.device, tags);
  return labels;
}

// Returns an inner voxel of each fragment: of the node nearest to its center.
std::vector<Seed> innerVoxels(GrowthState& state, const SplitNodes& nodes, std::size_t index,
                              const SplitFracture& fracture, std::span<const glm::ivec3> low) {
  struct Nearest {
    double distance = -1.0;
    SplitNodes::Target target{};
  };
  std::vector<Nearest> nearest(fracture.ids.size() + 1);
  std::vector<glm::dvec3> mean;
  for (const VoxelSums& sums : fracture.sums) mean.push_back(sums.mean());
  for (std::size_t leaf = 0; leaf < state.leafCount; ++leaf) {
    const std::size_t item = index * state.leafCount + leaf;
    const auto [first, last] = nodes.of(item);
    for (std::uint32_t node = first; node < last; ++node) {
      const std::uint16_t label = nodes.label(node);
      const glm::dvec3 apart = nodes.sums(node).mean() + glm::dvec3(low[leaf]) - mean[label];
      const double distance = glm::dot(apart, apart);
      Nearest& best = nearest[label];
      if (best.distance >= 0.0 && distance >= best.distance) continue;
      best = {distance,
              {static_cast<std::uint32_t>(item), node - first,
               glm::ivec3(glm::floor(mean[label] + 0.5)) - low[leaf]}};
    }
  }
  std::vector<SplitNodes::Target> targets;
  for (std::size_t label = 1; label < nearest.size(); ++label) {
    targets.push_back(nearest[label].target);
  }
  const std::vector<std::uint16_t> offsets = nodes.nearestVoxels(state, targets);
  std::vector<Seed> seeds;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const openvdb::Coord voxel =
        state.blocks.origins[targets[i].item % state.leafCount] + coordFromOffset(offsets[i]);
    seeds.push_back({voxel, static_cast<std::uint16_t>(i + 1)});
  }
  return seeds;
}

// [fragments] the shares that they were meant to have, by id.
std::vector<double> meantSharesOf(const SplitFracture& fracture) {
  std::vector<double> shares(fracture.pieces.size());
  for (const SplitPiece& piece : fracture.pieces) {
    shares[piece.label - 1u] = fracture.shares[piece.first];
  }
  return shares;
}

// Converts planes to voxels of the grid.
Split inGrid(Split split, const openvdb::Coord& lowest) {
  for (int i = 0; i < 3; ++i) {
    split.offset += 64 * std::int64_t{split.normal[i]} * lowest[i];
    if (split.isSphere) split.center[i] += 64 * lowest[i];
  }
  return split;
}

// The same, ordered by the size of what they split.
std::vector<Split> ordered(std::vector<Split> splits, const openvdb::Coord& lowest) {
  std::stable_sort(splits.begin(), splits.end(),
                   [](const Split& a, const Split& b) { return a.voxels > b.voxels; });
  for (Split& split : splits) split = inGrid(split, lowest);
  return splits;
}

// What was decided, for another solid of the mesh.
GivenSplits decidedOf(SplitFracture& fracture) {
  GivenSplits all{.roots = std::move(fracture.roots)};
  for (const GivenSplit& each : fracture.decided) {
    all.splits.push_back({inGrid(each.split, fracture.lowest), each.kept});
  }
  all.leastVoxels = static_cast<std::uint64_t>(fracture.sums[1].count);
  for (std::size_t id = 1; id < fracture.sums.size(); ++id) {
    all.leastVoxels =
        std::min(all.leastVoxels, static_cast<std::uint64_t>(fracture.sums[id].count));
  }
  all.shares = std::move(fracture.shares);
  return all;
}

std::vector<glm::ivec3> lowestOfLeaves(const LeafBlocks& blocks, const openvdb::Coord& from) {
  std::vector<glm::ivec3> low;
  for (const openvdb::Coord& origin : blocks.origins) {
    const openvdb::Coord at = origin - from;
    low.emplace_back(at.x(), at.y(), at.z());
  }
  return low;
}

bool isDone(const SplitFracture& fracture) {
  return std::none_of(fracture.pieces.begin(), fracture.pieces.end(),
                      [](const SplitPiece& piece) { return piece.isSplit(); });
}

}  // namespace

SplitGrowth splitPieces(GrowthState& state, const VoxelComponents& components,
                        std::span<const SplitRun> runs, const GrowOptions& options,
                        const Progress* progress) {
  std::vector<SplitFracture> fractures;
  const openvdb::Coord lowest = state.lowest();
  for (const SplitRun& run : runs)
    fractures.push_back(startedFracture(run, state.blocks, components, lowest));
  const DeviceBuffer origins = state.uploadOrigins(lowest);
  std::vector<std::shared_ptr<const WallMiddles>> middles;
  for (const SplitRun& run : runs) middles.push_back(run.middles);
  const WaysOnDevice ways = WallWays(state, middles).uploaded(state.device);
  const std::vector<glm::ivec3> low = lowestOfLeaves(state.blocks, lowest);
  SplitGrowth grown{componentLabels(state, components, fractures), {}};
  SplitNodes nodes = SplitNodes::withoutRoots(state, grown.labels);
  const auto measure = [&] {
    for (std::size_t f = 0; f < fractures.size(); ++f) {
      SplitFracture& each = fractures[f];
      each.sums = sumsOfLabels(state, nodes, f, each.ids.size(), low);
      each.mass = massOfLabels(state, nodes, f, each.sums, runs[f].densities);
    }
  };
  measure();
  const auto finishGeneration = [&] {
    nodes = SplitNodes(state, grown.labels);
    connectSides(state, grown.labels, nodes, fractures);
    measure();
    for (SplitFracture& fracture : fractures) recordSplits(fracture);
  };
  const auto isAllDone = [&] { return std::all_of(fractures.begin(), fractures.end(), isDone); };
  const GuideSides* const guides = runs.front().guides;
  if (guides && !guides->positive.empty()) {
    const auto sides = sidesOfComponents(state.blocks, components, *guides);
    for (SplitFracture& fracture : fractures) {
      for (std::size_t i = 0; i < sides.size(); ++i) fracture.pieces[i].sides = sides[i];
    }
  }
  for (std::size_t i = 0; guides && i < guides->positive.size() && !isAllDone(); ++i) {
    reportProgress(progress, "grow", 0.0);
    for (SplitFracture& fracture : fractures) splitAll(fracture, i);
    splitBySides(state, grown.labels, guides->positive[i], fractures);
    finishGeneration();
  }
  while (!isAllDone()) {
    reportProgress(progress, "grow", 0.0);
    throwIfCancelled(progress);
    for (std::size_t f = 0; f < fractures.size(); ++f) {
      decidePlanes(state, nodes, f, fractures[f], low, runs[f], options);
    }
    splitByPlanes(state, grown.labels, origins, ways, fractures);
    finishGeneration();
  }
  for (std::size_t f = 0; f < fractures.size(); ++f) {
    grown.fractures.push_back({ordered(std::move(fractures[f].splits), lowest),
                               innerVoxels(state, nodes, f, fractures[f], low),
                               meantSharesOf(fractures[f]), decidedOf(fractures[f])});
  }
  return grown;
}

}  // namespace sherd
