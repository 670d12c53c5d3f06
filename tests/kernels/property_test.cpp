// Properties of every fracture, tested on random solids with random options: components, seeds,
// growth, batches and erosion.
//
// SHERD_PROPERTY_CASES  number of cases, default 300 (20 with SHERD_TEST_SMALL=1)
// SHERD_PROPERTY_FIRST  number of the first case; a failure prints its number, to be run alone
#include <sherd/error.h>

#include <numeric>
#include <string>

#include "grow_reference.h"
#include "random_case.h"

namespace sherd {
namespace {

using openvdb::Coord;
using reference::LabelMap;

using Properties = DeviceTest;

std::size_t additionalSeeds(const SeedOptions& options, const ShapeSolid& on) {
  const int impacts = static_cast<int>(options.impacts.size()) + options.randomImpacts;
  const int beyond = options.pieces - static_cast<int>(on.components.count());
  int additional = options.extraSeeds;
  for (const Impact& impact : options.impacts) {
    if (!impact.merge) continue;
    additional += impact.count > 0 ? impact.count : std::max(beyond / 2 / impacts, 1);
  }
  return static_cast<std::size_t>(additional);
}

void expectComponents(const ShapeSolid& on) {
  LabelMap solid;
  for (const Coord& v : on.shape.inside) solid[v] = 1;
  EXPECT_EQ(on.components.count(), reference::countConnectedComponents(solid));
  std::vector<std::uint64_t> voxels(on.components.count());
  std::size_t disconnected = 0;
  for (const Coord& v : on.shape.inside) {
    ++voxels[on.componentOf(v)];
    for (const Coord& n : voxel_shapes::neighbors(v)) {
      disconnected += on.shape.inside.count(n) && on.componentOf(n) != on.componentOf(v);
    }
  }
  EXPECT_EQ(disconnected, 0u);
  EXPECT_EQ(voxels, on.components.voxels());
}

void expectGrowth(const ShapeSolid& on, const std::vector<Seed>& seeds, const Labels& labels,
                  const GrowOptions& options) {
  const LeafBlocks& blocks = *on.solid.blocks;
  const int fragments = fragmentsOf(seeds);
  const LabelMap map = reference::mapOf(labels);
  EXPECT_EQ(map.size(), on.solid.voxels) << "voxels without a label";
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(fragments) + 1);
  for (const auto& [voxel, label] : map) {
    ASSERT_LE(label, fragments) << voxel;
    ++counts[label];
  }
  EXPECT_EQ(countVoxels(labels), counts);
  const bool rough = !options.roughness.isZero();  // may move a fragment off its seed's voxel
  for (std::size_t i = 0; i < static_cast<std::size_t>(fragments) && !rough; ++i) {
    EXPECT_EQ(map.at(seeds[i].voxel), seeds[i].fragment) << "a fragment lost its first seed";
  }
  if (options.regrowIsolated) {
    EXPECT_EQ(reference::countConnectedComponents(map), static_cast<std::size_t>(fragments))
        << "a fragment is disconnected or missing";
  }
  std::size_t stray = 0;  // labels outside the solid and its exterior band
  for (std::size_t voxelIndex = 0; voxelIndex < labels.fragment.size(); ++voxelIndex) {
    std::uint64_t allowed = blocks.inside[voxelIndex / 64];
    if (options.outerSteps > 0) allowed |= blocks.exteriorBand[voxelIndex / 64];
    stray += labels.fragment[voxelIndex] != 0 && !((allowed >> (voxelIndex % 64)) & 1);
  }
  EXPECT_EQ(stray, 0u);
}

void expectErosion(const ShapeSolid& on, const Labels& before, int fragments,
                   const ErodeOptions& options, Device& device) {
  const LeafBlocks& blocks = *on.solid.blocks;
  const Erosion eroded = erode(before, options, device);
  std::size_t wrong = 0;
  for (std::size_t voxelIndex = 0; voxelIndex < before.fragment.size(); ++voxelIndex) {
    const bool inside = (blocks.inside[voxelIndex / 64] >> (voxelIndex % 64)) & 1;
    const std::uint16_t now = eroded.labels.fragment[voxelIndex];
    wrong += now != before.fragment[voxelIndex] && !(inside && now == Labels::kEroded);
  }
  EXPECT_EQ(wrong, 0u) << "erosion gave a voxel to another fragment";
  const auto was = countVoxels(before);
  const auto is = countVoxels(eroded.labels);
  ASSERT_EQ(eroded.eroded.size(), was.size());
  for (std::size_t id = 1; id < was.size(); ++id) {
    EXPECT_GE(is[id], 1u);
    EXPECT_EQ(was[id] - is[id], eroded.eroded[id]) << id;
  }
  EXPECT_EQ(eroded.eroded[0],
            std::accumulate(eroded.eroded.begin() + 1, eroded.eroded.end(), 0ull));
  EXPECT_TRUE(!options.iterations.isZero() || eroded.eroded[0] == 0);
  if (!options.iterations.isZero() && options.islands == Islands::eroded) {
    LabelMap left = reference::mapOf(eroded.labels);
    std::erase_if(left, [](const auto& voxel) { return voxel.second == Labels::kEroded; });
    EXPECT_EQ(reference::countConnectedComponents(left), static_cast<std::size_t>(fragments));
  }
  const Erosion again = erode(before, options, device);
  EXPECT_EQ(again.labels.fragment, eroded.labels.fragment);
  EXPECT_EQ(again.eroded, eroded.eroded);
}

// Compares two fractures grown together with each alone under another schedule.
void expectBatch(const std::shared_ptr<const LeafBlocks>& blocks,
                 const std::vector<std::vector<Seed>>& sets, const std::vector<Labels>& together,
                 GrowOptions options, Device& device) {
  const std::vector<std::uint64_t> noise = options.noiseSeeds;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    options.noiseSeeds = {noise[i]};
    options.tuning.workGroupSize = options.tuning.workGroupSize == 1 ? 0 : 1;
    options.tuning.stepsPerReadback = 3;
    const Labels alone = std::move(grow(blocks, std::span(&sets[i], 1), device, options).front());
    EXPECT_EQ(alone.fragment, together[i].fragment) << "fracture " << i;
    EXPECT_EQ(alone.cost, together[i].cost) << "fracture " << i;
  }
}

// Places seeds; without impacts if these need more voxels than the component that they hit has.
std::vector<Seed> placed(const ShapeSolid& on, SeedOptions& options) {
  try {
    return placeSeeds(on.solid, on.components, options);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::usage || on.components.count() == 1) throw;
  }
  options.impacts.clear();
  options.randomImpacts = 0;
  return placeSeeds(on.solid, on.components, options);
}

void tryCase(std::uint64_t number, Device& device) {
  random_case::Draw draw(number);
  ShapeSolid on(random_case::anySolid(draw), device);
  on.solid.frame = {{draw.between(-5.0, 5.0), 0.5, -1.0}, draw.of({1.0, 0.01, 37.5})};
  SeedOptions seedOptions = random_case::anySeeds(draw, on);
  const GrowOptions growOptions = random_case::anyGrowth(draw);
  const ErodeOptions erodeOptions = random_case::anyErosion(draw);
  expectComponents(on);

  std::vector<std::vector<Seed>> sets{placed(on, seedOptions)};
  EXPECT_EQ(placeSeeds(on.solid, on.components, seedOptions), sets[0]);
  const auto fragments =
      std::max(static_cast<std::size_t>(seedOptions.pieces), on.components.count());
  expectPromises(on, sets[0], fragments, additionalSeeds(seedOptions, on), seedOptions);
  if (testing::Test::HasFailure()) return;
  seedOptions.seed += 1;
  sets.push_back(placed(on, seedOptions));

  const std::vector<Labels> grown = grow(on.solid.blocks, sets, device, growOptions);
  for (std::size_t i = 0; i < sets.size(); ++i) expectGrowth(on, sets[i], grown[i], growOptions);
  expectBatch(on.solid.blocks, sets, grown, growOptions, device);
  expectErosion(on, grown[0], static_cast<int>(fragments), erodeOptions, device);
}

std::uint64_t numberFrom(const char* name, std::uint64_t fallback) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : fallback;
}

TEST_F(Properties, HoldForRandomOptionsOnRandomSolids) {
  const std::uint64_t first = numberFrom("SHERD_PROPERTY_FIRST", 0);
  const std::uint64_t cases = numberFrom("SHERD_PROPERTY_CASES", voxel_shapes::small() ? 20 : 300);
  for (std::uint64_t number = first; number < first + cases && !HasFailure(); ++number) {
    SCOPED_TRACE("case " + std::to_string(number) +
                 "; alone: SHERD_PROPERTY_CASES=1 SHERD_PROPERTY_FIRST=" + std::to_string(number));
    EXPECT_NO_THROW(tryCase(number, device()));
  }
}

}  // namespace
}  // namespace sherd
