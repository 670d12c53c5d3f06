// The pieces of a fracture while they are split.
#pragma once

#include <sherd/labels.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "grow/fields/growth_state.h"
#include "grow/sized/split_plan.h"
#include "grow/splits/sequential.h"
#include "grow/splits/split_impact.h"
#include "grow/splits/split_nodes.h"

namespace sherd {

/// A piece, and the shares of the fragments that come of it: [first, last) of its fracture's.
struct SplitPiece {
  std::uint16_t label = 0;
  std::size_t first = 0, last = 0;
  int generation = 0;
  std::uint64_t path = 0;              // hash of the sides of all splits before, for random numbers
  bool missed = false;                 // the last plane had all voxels on one side
  std::vector<std::uint64_t> sides{};  // of given cracks, that its voxels are on, ascending: a bit
                                       // for each of the first 64

  std::uint32_t component = 0;
  bool isGiven = false;                 // its next split is
  std::size_t nextImpact = 0;           // those before have struck
  std::optional<ImpactPart> pattern{};  // of an impact, that is not divided yet

  bool isSplit() const { return last - first > 1; }
};

/// The plane or the sphere through a piece, and the label of the positive side.
struct SplitPlane {
  glm::ivec3 normal{0};
  std::int64_t offset = 0;
  std::uint16_t added = 0;
  bool isSphere = false;
  bool ignoresWalls = false;            // a plane that is compared with the voxels themselves
  glm::ivec3 center{0};                 // of a sphere, 1/64 voxel
  std::optional<ImpactSplit> impact{};  // what the crack is of an impact's pattern
};

/// One fracture on the host.
struct SplitFracture {
  std::uint64_t seed = 0;
  std::vector<double> shares{};
  std::vector<std::uint16_t> ids{};  // in the order in which pieces take them
  std::size_t taken = 0;
  std::vector<SplitPiece> pieces{};
  std::vector<Split> splits{};
  std::vector<VoxelSums> sums{};       // [labels + 1]
  std::vector<double> mass{};          // [labels + 1] voxels times densities
  std::vector<SplitPlane> planes{};    // [labels + 1] of this generation
  std::vector<SplitImpact> impacts{};  // from the lowest voxel of all
  std::vector<GivenSplits::Root> roots{};
  std::vector<GivenSplit> decided{};  // so far, from the lowest voxel
  GivenOrder given{};
  openvdb::Coord lowest{};  // of all voxels

  std::uint16_t nextId() { return ids[taken++]; }
  void returnId(std::uint16_t id);
};

/// Makes one piece of each component.
///   lowest  voxel of all
[[nodiscard]] SplitFracture startedFracture(const SplitRun& run, const LeafBlocks& blocks,
                                            const VoxelComponents& components,
                                            const openvdb::Coord& lowest);

/// Decides the planes of all pieces that are split next, and gives ids to the new ones.
///   low  [leaves] the lowest voxel of each, from the lowest of all
void decidePlanes(const GrowthState& state, const SplitNodes& nodes, std::size_t index,
                  SplitFracture& fracture, std::span<const glm::ivec3> low, const SplitRun& run,
                  const GrowOptions& options);

/// Labels components anew, so that both sides of every piece are connected: the largest component
/// of each side is a part, the others join what they touch first.
void connectSides(GrowthState& state, const DeviceLabels& labels, SplitNodes& nodes,
                  std::span<const SplitFracture> fractures);

/// Replaces split pieces by their two parts, and records the splits.
void recordSplits(SplitFracture& fracture);

/// Returns [components] on which sides of given cracks their voxels are.
[[nodiscard]] std::vector<std::vector<std::uint64_t>> sidesOfComponents(
    const LeafBlocks& blocks, const VoxelComponents& components, const GuideSides& guides);

}  // namespace sherd
