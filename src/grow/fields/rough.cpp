// Host side of kernels/rough.cl.
#include "grow/fields/rough.h"

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

#include "noise_octave.h"

namespace sherd {
namespace {

std::vector<sherd_octave> octavesOf(const NoiseOctaves& octaves) {
  std::vector<sherd_octave> all;
  for (std::size_t n = 0; n < octaves.step.size(); ++n) {
    sherd_octave& octave =
        all.emplace_back(sherd_octave{.step = {octaves.step[n], octaves.step[n], octaves.step[n]},
                                      .amplitude = octaves.amplitude[n],
                                      .number = octaves.first + static_cast<std::int32_t>(n)});
    octave.step[octaves.propagation] = octaves.propagationStep[n];
  }
  return all;
}

// Returns how many leaves away a walk can end.
std::uint32_t leavesReached(std::span<const std::int32_t> amplitudes, bool isAnchored) {
  std::int64_t longest = 0;  // 1/256 voxel
  for (const std::int32_t amplitude : amplitudes) longest += std::abs(std::int64_t{amplitude}) + 1;
  longest = 128 + (isAnchored ? 2 : 1) * longest;  // 128 rounds to the nearest voxel
  return static_cast<std::uint32_t>((longest / 256 + 7) / 8);
}

// Per-leaf data that shortens walks.
struct LeafSummaries {
  DeviceBuffer
      uniformRings;   // [items] rings of leaves with at most one label, the leaf itself first
  DeviceBuffer full;  // [items] 1: all voxels are inside
};

LeafSummaries summarizeLeaves(GrowthState& state, const DeviceLabels& labels, std::uint32_t reach) {
  constexpr std::uint32_t kMaxRings = 16;  // a leaf with a longer walk counts as near a crack
  LeafSummaries leaves{state.filled<std::uint32_t>(state.items, 0),
                       makeBuffer<std::uint32_t>(state.device, state.items)};
  DeviceBuffer single = makeBuffer<std::uint32_t>(state.device, state.items);
  DeviceBuffer wider = makeBuffer<std::uint32_t>(state.device, state.items);
  state.run("rough_leaves", state.items, state.inside, state.leafCount, state.items, labels.owner,
            labels.tag, labels.second, single, leaves.full);
  for (std::uint32_t ring = 0; ring <= std::min(reach, kMaxRings); ++ring) {
    state.run("rough_rings", state.items, state.neighbors27(), state.leafCount, state.items, ring,
              single, wider, leaves.uniformRings);
    std::swap(single, wider);
  }
  return leaves;
}

}  // namespace

DeviceBuffer roughened(GrowthState& state, const DeviceLabels& labels, const SeedTable& seeds,
                       std::span<const std::uint64_t> noiseSeeds,
                       std::span<const std::optional<openvdb::Coord>> anchors,
                       const NoiseOctaves& octaves) {
  std::vector<Int4> anchorVoxels(state.fractures, Int4{0, 0, 0, 0});
  bool isAnchored = false;
  for (std::size_t f = 0; f < std::min(anchors.size(), anchorVoxels.size()); ++f) {
    if (!anchors[f]) continue;
    anchorVoxels[f] = {anchors[f]->x(), anchors[f]->y(), anchors[f]->z(), 1};
    isAnchored = true;
  }
  const DeviceBuffer noise = uploadBuffer<std::uint64_t>(state.device, noiseSeeds);
  const std::vector<sherd_octave> each = octavesOf(octaves);
  const DeviceBuffer octave = uploadBuffer<sherd_octave>(state.device, each);
  const DeviceBuffer voxels = uploadBuffer<Int4>(state.device, anchorVoxels);
  const DeviceBuffer anchor = makeBuffer<Int4>(state.device, state.fractures);
  const auto octaveCount = static_cast<std::uint32_t>(octaves.step.size());
  state.run("rough_at", state.fractures, voxels, state.fractures, noise, octave, octaveCount,
            anchor);
  const DeviceBuffer out = makeBuffer<std::uint16_t>(state.device, state.voxels());
  const LeafSummaries leaves =
      summarizeLeaves(state, labels, leavesReached(octaves.amplitude, isAnchored));
  state.run("rough", state.items, state.inside, state.neighbor, state.neighbors27(), state.origin(),
            state.leafCount, state.items, noise, octave, octaveCount, anchor, leaves.uniformRings,
            leaves.full, labels.owner, labels.tag, labels.second, out);

  const PrimarySeeds primaries = primariesOf(state, seeds);
  state.run("rough_pin", primaries.count, primaries.item, primaries.offset, primaries.label,
            primaries.count, out);
  state.device.finish();  // the local buffers are released here
  return out;
}

}  // namespace sherd
