// Growth on the device beside a serial queue, in the same run.
//
// The queue is the plainest fast flood: a FIFO of 32-bit voxel indices over a dense uint16 array.
// Both grow the same ball from the same ten seeds; both are warm.  Run with
// --benchmark_enable_random_interleaving=true
// --benchmark_repetitions=9 --benchmark_report_aggregates_only=true and compare medians
// (tools/bench.sh does).
#include <benchmark/benchmark.h>
#include <sherd/labels.h>

#include <map>
#include <memory>
#include <vector>

namespace {

using openvdb::Coord;

// A ball that fills a box of `size` voxels, as leaf blocks and as a dense array with a free border.
struct Ball {
  int size;
  std::uint64_t voxels = 0;
  sherd::LeafBlocks blocks;
  std::vector<sherd::Seed> seeds;

  explicit Ball(int side) : size(side) {
    for (int x = 0; x < size; x += 8) {
      for (int y = 0; y < size; y += 8) {
        for (int z = 0; z < size; z += 8) addLeaf({x, y, z});
      }
    }
    blocks.outerBand.assign(blocks.inside.size(), 0);
    blocks.neighbours = sherd::leafNeighbours(blocks.origins);
    voxels = blocks.insideVoxels();
    // Ten seeds by a fixed stride over the leaves.
    for (std::uint16_t id = 1; id <= 10; ++id) {
      std::size_t leaf = blocks.count() * id / 11;
      while (blocks.inside[leaf * 8 + 4] == 0) ++leaf;
      const int bit = std::countr_zero(blocks.inside[leaf * 8 + 4]);
      seeds.push_back({blocks.origins[leaf] + Coord(4, bit >> 3, bit & 7), id});
    }
  }

  bool contains(int x, int y, int z) const {
    const std::int64_t cx = 2 * x + 1 - size, cy = 2 * y + 1 - size, cz = 2 * z + 1 - size;
    return cx * cx + cy * cy + cz * cz <= static_cast<std::int64_t>(size) * size;
  }

  void addLeaf(const Coord& origin) {
    std::uint64_t words[8] = {}, any = 0;
    for (int v = 0; v < 512; ++v) {
      if (contains(origin.x() + (v >> 6), origin.y() + ((v >> 3) & 7), origin.z() + (v & 7))) {
        words[v >> 6] |= std::uint64_t{1} << (v & 63);
      }
    }
    for (const std::uint64_t word : words) any |= word;
    if (!any) return;
    blocks.origins.push_back(origin);
    blocks.inside.insert(blocks.inside.end(), words, words + 8);
  }
};

const Ball& ball(int size) {
  static std::map<int, std::unique_ptr<Ball>> made;
  std::unique_ptr<Ball>& entry = made[size];
  if (!entry) entry = std::make_unique<Ball>(size);
  return *entry;
}

sherd::Device& device() {
  static sherd::Device* const opened = new sherd::Device("auto");
  return *opened;
}

void report(benchmark::State& state, const Ball& solid) {
  state.counters["voxels/s"] = benchmark::Counter(static_cast<double>(solid.voxels),
                                                  benchmark::Counter::kIsIterationInvariantRate);
}

// Upload, growth and read-back of the labels: everything a fracture pays for.
void growDevice(benchmark::State& state) {
  const Ball& solid = ball(static_cast<int>(state.range(0)));
  const std::vector<std::vector<sherd::Seed>> sets{solid.seeds};
  for (auto _ : state) {
    benchmark::DoNotOptimize(sherd::grow(solid.blocks, sets, device(),
                                         {.growth = sherd::Growth::flood, .outerSteps = 0}));
  }
  report(state, solid);
}

void growSerialQueue(benchmark::State& state) {
  const Ball& solid = ball(static_cast<int>(state.range(0)));
  const std::size_t side = static_cast<std::size_t>(solid.size) + 2;  // a border: no bounds to test
  const std::uint32_t steps[3] = {static_cast<std::uint32_t>(side * side),
                                  static_cast<std::uint32_t>(side), 1};
  std::vector<std::uint16_t> empty(side * side * side, 0xffff);  // 0xffff outside, 0 free
  const auto at = [&](const Coord& v) {
    return (static_cast<std::size_t>(v.x() + 1) * side + static_cast<std::size_t>(v.y() + 1)) *
               side +
           static_cast<std::size_t>(v.z() + 1);
  };
  for (int x = 0; x < solid.size; ++x) {
    for (int y = 0; y < solid.size; ++y) {
      for (int z = 0; z < solid.size; ++z) {
        if (solid.contains(x, y, z)) empty[at({x, y, z})] = 0;
      }
    }
  }
  std::vector<std::uint32_t> queue(solid.voxels);
  std::vector<std::uint16_t> labels;
  for (auto _ : state) {
    state.PauseTiming();
    labels = empty;
    state.ResumeTiming();
    std::size_t head = 0, tail = 0;
    for (const sherd::Seed& seed : solid.seeds) {
      labels[at(seed.voxel)] = seed.fragment;
      queue[tail++] = static_cast<std::uint32_t>(at(seed.voxel));
    }
    while (head < tail) {
      const std::uint32_t voxel = queue[head++];
      const std::uint16_t label = labels[voxel];
      for (const std::uint32_t step : steps) {
        for (const std::uint32_t next : {voxel - step, voxel + step}) {
          if (labels[next] != 0) continue;
          labels[next] = label;
          queue[tail++] = next;
        }
      }
    }
    benchmark::ClobberMemory();
  }
  report(state, solid);
}

// Every way of growing.
struct Way {
  const char* name;
  sherd::GrowOptions options;
};
const std::vector<Way>& ways() {
  using sherd::Growth;
  static const std::vector<Way> all{
      {"flood", {.growth = Growth::flood}},
      {"flood, 26 neighbours", {.growth = Growth::flood, .neighborhood = 26}},
      {"nearest, kept", {.growth = Growth::nearest, .regrowIsolated = false}},
      {"nearest", {.growth = Growth::nearest}},
      {"euclid", {.growth = Growth::euclid}},
      {"chain", {.growth = Growth::chain}},
      {"euclid, grain", {.growth = Growth::euclid, .grain = {{0, 0, 1}, 2.0}}},
      {"euclid, roughness 2", {.growth = Growth::euclid, .roughness = 2.0}}};
  return all;
}

void growWay(benchmark::State& state) {
  const Ball& solid = ball(static_cast<int>(state.range(0)));
  const Way& way = ways()[static_cast<std::size_t>(state.range(1))];
  sherd::GrowOptions options = way.options;
  options.outerSteps = 0;
  const std::vector<std::vector<sherd::Seed>> sets{solid.seeds};
  for (auto _ : state) {
    benchmark::DoNotOptimize(sherd::grow(solid.blocks, sets, device(), options));
  }
  state.SetLabel(way.name);
  report(state, solid);
}

BENCHMARK(growWay)
    ->Name("grow/way")
    ->ArgsProduct({{128, 256}, benchmark::CreateDenseRange(0, 7, 1)})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(growDevice)
    ->Name("grow/device")
    ->Arg(128)
    ->Arg(256)
    ->Arg(512)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(growSerialQueue)
    ->Name("grow/serial_queue")
    ->Arg(128)
    ->Arg(256)
    ->Arg(512)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
