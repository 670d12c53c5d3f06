// What every fracture promises, tried on random solids with random options: parts, seeds, growth,
// batches and erosion.
//
// SHERD_PROPERTY_CASES  how many cases, 300 unless told (20 where SHERD_TEST_SMALL=1)
// SHERD_PROPERTY_FIRST  the first one's number; a failing case tells its own, to be run alone
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

std::size_t furtherSeeds(const SeedOptions& options, const ShapeSolid& on) {
  const int impacts = static_cast<int>(options.impacts.size()) + options.randomImpacts;
  const int beyond = options.pieces - static_cast<int>(on.parts.count());
  int further = options.extraSeeds;
  for (const Impact& impact : options.impacts) {
    if (!impact.merge) continue;
    further += impact.count > 0 ? impact.count : std::max(beyond / 2 / impacts, 1);
  }
  return static_cast<std::size_t>(further);
}

void expectParts(const ShapeSolid& on) {
  LabelMap solid;
  for (const Coord& v : on.shape.inside) solid[v] = 1;
  EXPECT_EQ(on.parts.count(), reference::connectedParts(solid));
  std::vector<std::uint64_t> voxels(on.parts.count());
  std::size_t torn = 0;
  for (const Coord& v : on.shape.inside) {
    ++voxels[on.partOf(v)];
    for (const Coord& n : voxel_shapes::neighbours(v)) {
      torn += on.shape.inside.count(n) && on.partOf(n) != on.partOf(v);
    }
  }
  EXPECT_EQ(torn, 0u);
  EXPECT_EQ(voxels, on.parts.voxels);
}

void expectGrowth(const ShapeSolid& on, const std::vector<Seed>& seeds, const Labels& labels,
                  const GrowOptions& options) {
  const LeafBlocks& blocks = on.solid.blocks;
  const int fragments = fragmentsOf(seeds);
  const LabelMap map = reference::mapOf(blocks, labels);
  EXPECT_EQ(map.size(), on.solid.voxels) << "voxels without a label";
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(fragments) + 1);
  for (const auto& [voxel, label] : map) {
    ASSERT_LE(label, fragments) << voxel;
    ++counts[label];
  }
  EXPECT_EQ(countVoxels(blocks, labels, fragments), counts);
  const bool rough = options.roughness > 0.0;  // which may carry a fragment off its seed's voxel
  for (std::size_t i = 0; i < static_cast<std::size_t>(fragments) && !rough; ++i) {
    EXPECT_EQ(map.at(seeds[i].voxel), seeds[i].fragment) << "a fragment lost its first seed";
  }
  if (options.regrowIsolated) {
    EXPECT_EQ(reference::connectedParts(map), static_cast<std::size_t>(fragments))
        << "a fragment is torn or lost";
  }
  std::size_t stray = 0;  // labels outside the solid, and beyond its outer band if that has any
  for (std::size_t place = 0; place < labels.fragment.size(); ++place) {
    std::uint64_t allowed = blocks.inside[place / 64];
    if (options.outerSteps > 0) allowed |= blocks.outerBand[place / 64];
    stray += labels.fragment[place] != 0 && !((allowed >> (place % 64)) & 1);
  }
  EXPECT_EQ(stray, 0u);
}

void expectErosion(const ShapeSolid& on, const Labels& before, int fragments,
                   const ErodeOptions& options, Device& device) {
  const LeafBlocks& blocks = on.solid.blocks;
  const Erosion eroded = erode(blocks, before, fragments, options, device);
  std::size_t strange = 0;
  for (std::size_t place = 0; place < before.fragment.size(); ++place) {
    const bool inside = (blocks.inside[place / 64] >> (place % 64)) & 1;
    const std::uint16_t now = eroded.labels.fragment[place];
    strange += now != before.fragment[place] && !(inside && now == Labels::kWorn);
  }
  EXPECT_EQ(strange, 0u) << "erosion gave a voxel to another fragment";
  const auto was = countVoxels(blocks, before, fragments);
  const auto is = countVoxels(blocks, eroded.labels, fragments);
  ASSERT_EQ(eroded.worn.size(), was.size());
  for (std::size_t id = 1; id < was.size(); ++id) {
    EXPECT_GE(is[id], 1u);
    EXPECT_EQ(was[id] - is[id], eroded.worn[id]) << id;
  }
  EXPECT_EQ(eroded.worn[0], std::accumulate(eroded.worn.begin() + 1, eroded.worn.end(), 0ull));
  EXPECT_TRUE(options.iterations > 0 || eroded.worn[0] == 0);
  if (options.iterations > 0 && options.crumbs == Crumbs::worn) {
    LabelMap left = reference::mapOf(blocks, eroded.labels);
    std::erase_if(left, [](const auto& voxel) { return voxel.second == Labels::kWorn; });
    EXPECT_EQ(reference::connectedParts(left), static_cast<std::size_t>(fragments));
  }
  const Erosion again = erode(blocks, before, fragments, options, device);
  EXPECT_EQ(again.labels.fragment, eroded.labels.fragment);
  EXPECT_EQ(again.worn, eroded.worn);
}

// Two fractures grown together, and each alone by another schedule.
void expectBatch(const LeafBlocks& blocks, const std::vector<std::vector<Seed>>& sets,
                 const std::vector<Labels>& together, GrowOptions options, Device& device) {
  const std::vector<std::uint64_t> noise = options.noiseSeeds;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    options.noiseSeeds = {noise[i]};
    options.workGroupSize = options.workGroupSize == 1 ? 0 : 1;
    options.stepsPerReadback = 3;
    const Labels alone = std::move(grow(blocks, std::span(&sets[i], 1), device, options).front());
    EXPECT_EQ(alone.fragment, together[i].fragment) << "fracture " << i;
    EXPECT_EQ(alone.cost, together[i].cost) << "fracture " << i;
  }
}

// Impacts may ask for more room than the part that they strike has: then without them.
std::vector<Seed> placed(const ShapeSolid& on, SeedOptions& options) {
  try {
    return placeSeeds(on.solid, on.parts, options);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::usage || on.parts.count() == 1) throw;
  }
  options.impacts.clear();
  options.randomImpacts = 0;
  return placeSeeds(on.solid, on.parts, options);
}

void tryCase(std::uint64_t number, Device& device) {
  random_case::Draw draw(number);
  ShapeSolid on(random_case::anySolid(draw), device);
  on.solid.frame = {{{draw.between(-5.0, 5.0), 0.5, -1.0}}, draw.of({1.0, 0.01, 37.5})};
  SeedOptions seedOptions = random_case::anySeeds(draw, on);
  const GrowOptions growOptions = random_case::anyGrowth(draw);
  const ErodeOptions erodeOptions = random_case::anyErosion(draw);
  expectParts(on);

  std::vector<std::vector<Seed>> sets{placed(on, seedOptions)};
  EXPECT_EQ(placeSeeds(on.solid, on.parts, seedOptions), sets[0]);
  const auto fragments = std::max(static_cast<std::size_t>(seedOptions.pieces), on.parts.count());
  expectPromises(on, sets[0], fragments, furtherSeeds(seedOptions, on), seedOptions);
  if (testing::Test::HasFailure()) return;
  seedOptions.seed += 1;
  sets.push_back(placed(on, seedOptions));

  const LeafBlocks& blocks = on.solid.blocks;
  const std::vector<Labels> grown = grow(blocks, sets, device, growOptions);
  for (std::size_t i = 0; i < sets.size(); ++i) expectGrowth(on, sets[i], grown[i], growOptions);
  expectBatch(blocks, sets, grown, growOptions, device);
  expectErosion(on, grown[0], static_cast<int>(fragments), erodeOptions, device);
}

std::uint64_t numberFrom(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
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
