// Growth on the device beside two others, in the same run.
//
// The queue is the plainest fast flood: a FIFO of 32-bit voxel indices over a dense uint16 array.
// The two stacks are the paper's: on the same device, over a dense array, a launch for each layer
// with a work-item for each neighbor of each voxel on the stack.
// All grow the same ball from the same ten seeds; all are warm.  Run with
// --benchmark_enable_random_interleaving=true
// --benchmark_repetitions=9 --benchmark_report_aggregates_only=true and compare medians
// (tools/bench/bench.sh does).
#include <benchmark/benchmark.h>
#include <sherd/labels.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "ball.h"
#include "cl/open_cl_device.h"
#include "grow/sized/split_plan.h"
#include "grow/splits/sequential.h"

namespace {

using bench::ball, bench::Ball;

// The devices that benchmarks compare, in the order of their last argument.  They are never freed,
// as some drivers crash at exit.
constexpr std::array kDevices{"builtin", "pocl"};

sherd::Device& device(std::int64_t index = 0) {
  static std::array<sherd::Device*, kDevices.size()> opened{};
  const auto at = static_cast<std::size_t>(index);
  if (opened[at] == nullptr) opened[at] = new sherd::Device(kDevices[at]);
  return *opened[at];
}
sherd::Device& openClDevice() { return device(1); }

void report(benchmark::State& state, const Ball& solid) {
  state.counters["voxels/s"] = benchmark::Counter(static_cast<double>(solid.voxels),
                                                  benchmark::Counter::kIsIterationInvariantRate);
}

// Upload, growth and read-back of the labels: everything a fracture pays for.
void growDevice(benchmark::State& state) {
  const Ball& solid = ball(static_cast<int>(state.range(0)));
  const std::vector<std::vector<sherd::Seed>> sets{solid.seeds};
  for (auto _ : state) {
    benchmark::DoNotOptimize(sherd::grow(solid.blocks, sets, device(state.range(1)),
                                         {.growth = sherd::Growth::flood, .outerSteps = 0}));
  }
  state.SetLabel(kDevices[static_cast<std::size_t>(state.range(1))]);
  report(state, solid);
}

void growSerialQueue(benchmark::State& state) {
  const Ball& solid = ball(static_cast<int>(state.range(0)));
  const std::array<std::uint32_t, 3> steps = solid.denseSteps();
  const std::vector<std::uint16_t> empty = solid.dense<std::uint16_t>();
  std::vector<std::uint32_t> queue(solid.voxels);
  std::vector<std::uint16_t> labels;
  for (auto _ : state) {
    state.PauseTiming();
    labels = empty;
    state.ResumeTiming();
    std::size_t head = 0, tail = 0;
    for (const sherd::Seed& seed : solid.seeds) {
      const std::size_t at = solid.denseAt(seed.voxel);
      labels[at] = seed.fragment;
      queue[tail++] = static_cast<std::uint32_t>(at);
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

constexpr const char* kTwoStacks = R"(
kernel void layer(const global uint* stack, const uint count, global uint* next, volatile global uint* nextCount,
                  volatile global uint* label, const uint x, const uint y)
{
  const size_t i = get_global_id(0);
  if (i >= (size_t)count * 6) return;
  const uint voxel = stack[i / 6];
  const int axis = (int)(i % 6) >> 1;
  const uint step = axis == 0 ? x : (axis == 1 ? y : 1u);
  const uint beside = i & 1 ? voxel + step : voxel - step;
  if (label[beside] == 0 && atomic_cmpxchg(&label[beside], 0u, label[voxel]) == 0) {
    next[atomic_inc(nextCount)] = beside;
  }
}
)";

// 32 bits a label, where the paper's has 16, for the exchange that keeps a voxel from being put on
// a stack twice.
void growTwoStacks(benchmark::State& state) {
  const Ball& solid = ball(static_cast<int>(state.range(0)));
  auto& impl = dynamic_cast<sherd::OpenClDevice&>(implOf(openClDevice()));
  cl::Program program(impl.context, kTwoStacks);
  program.build();
  cl::Kernel layer(program, "layer");
  std::vector<std::uint32_t> labels = solid.dense<std::uint32_t>(), seeds;
  for (const sherd::Seed& seed : solid.seeds) {
    seeds.push_back(static_cast<std::uint32_t>(solid.denseAt(seed.voxel)));
    labels[seeds.back()] = seed.fragment;
  }
  const std::array<std::uint32_t, 3> steps = solid.denseSteps();
  const std::size_t bytes = labels.size() * sizeof(std::uint32_t);
  const cl::Buffer label(impl.context, CL_MEM_READ_WRITE, bytes);
  const std::array<cl::Buffer, 2> stack{cl::Buffer(impl.context, CL_MEM_READ_WRITE, bytes),
                                        cl::Buffer(impl.context, CL_MEM_READ_WRITE, bytes)};
  const cl::Buffer counter(impl.context, CL_MEM_READ_WRITE, sizeof(cl_uint));
  std::vector<std::uint32_t> grown(labels.size());
  for (auto _ : state) {
    impl.queue.enqueueWriteBuffer(label, CL_TRUE, 0, bytes, labels.data());
    impl.queue.enqueueWriteBuffer(stack[0], CL_TRUE, 0, seeds.size() * sizeof(cl_uint),
                                  seeds.data());
    auto count = static_cast<cl_uint>(seeds.size());
    for (std::size_t from = 0; count > 0; from ^= 1) {
      impl.queue.enqueueFillBuffer<cl_uint>(counter, 0, 0, sizeof(cl_uint));
      layer.setArg(0, stack[from]);
      layer.setArg(1, count);
      layer.setArg(2, stack[from ^ 1]);
      layer.setArg(3, counter);
      layer.setArg(4, label);
      layer.setArg(5, steps[0]);
      layer.setArg(6, steps[1]);
      impl.queue.enqueueNDRangeKernel(layer, cl::NullRange, (std::size_t{count} * 6 + 63) / 64 * 64,
                                      64);
      impl.queue.enqueueReadBuffer(counter, CL_TRUE, 0, sizeof count, &count);
    }
    impl.queue.enqueueReadBuffer(label, CL_TRUE, 0, bytes, grown.data());
  }
  report(state, solid);
}

// What kernels/flood.cl does in a leaf, step by step.
struct LeafSteps {
  std::set<std::uint32_t> reached;               // in which something is reached
  std::array<std::set<std::uint32_t>, 6> faces;  // and at a face
  std::set<std::uint32_t> visited;
  bool severalLabels = false;
};

// A leaf is queued for the step after one in which it was reached and something is left, and after
// one that reached a voxel beside it and not from there.
std::vector<LeafSteps> leafSteps(const sherd::LeafBlocks& blocks, const sherd::Labels& grown) {
  std::vector<LeafSteps> leaves(blocks.count());
  for (std::uint32_t leaf = 0; leaf < blocks.count(); ++leaf) {
    LeafSteps& steps = leaves[leaf];
    std::uint16_t label = 0;
    for (std::size_t v = 0; v < 512; ++v) {
      const std::size_t voxelIndex = std::size_t{leaf} * 512 + v;
      if (!blocks.isInside(voxelIndex)) continue;
      const std::uint32_t step = grown.cost[voxelIndex];
      steps.reached.insert(step);
      steps.severalLabels |= label != 0 && label != grown.fragment[voxelIndex];
      label = grown.fragment[voxelIndex];
      for (std::uint32_t face = 0; face < 6; ++face) {
        const std::uint32_t shift = 6 - 3 * (face / 2), along = v >> shift & 7u;
        if (along != (face % 2 == 0 ? 0u : 7u)) continue;
        steps.faces[face].insert(step);
        const std::uint32_t other = blocks.neighbors[std::size_t{leaf} * 6 + face];
        if (other == sherd::LeafBlocks::kNone) continue;
        const std::size_t beside = std::size_t{other} * 512 + (v ^ (7u << shift));
        if (!blocks.isInside(beside) || grown.cost[beside] == step + 1) continue;
        steps.visited.insert(grown.cost[beside] + 1);
      }
    }
    const std::uint32_t last = *steps.reached.rbegin();
    for (const std::uint32_t step : steps.reached) {
      if (step < last) steps.visited.insert(step + 1);
    }
  }
  return leaves;
}

// Bytes that a visit in this step reads and writes.
std::size_t visitBytes(const sherd::LeafBlocks& blocks, const std::vector<LeafSteps>& leaves,
                       std::uint32_t leaf, std::uint32_t step) {
  const LeafSteps& own = leaves[leaf];
  std::size_t bytes = 4 + 64 + 64 + 4 + 6 * 4;  // list, owned, domain, tag, neighbors
  for (std::uint32_t face = 0; face < 6; ++face) {
    const std::uint32_t other = blocks.neighbors[std::size_t{leaf} * 6 + face];
    if (other == sherd::LeafBlocks::kNone) continue;
    const bool isLive = leaves[other].reached.count(step - 1) != 0;
    bytes += 4 + (isLive ? 8 + 4 : 0);  // their step, face and tag
    if (isLive && leaves[other].severalLabels) bytes += 8;
  }
  if (own.reached.count(step) == 0) return bytes;
  bytes += 64 + 6 * 8 + 2 * 4;                   // owned, the front
  if (own.severalLabels) bytes += 64 + 64 + 48;  // the second label's voxels and faces
  for (const std::set<std::uint32_t>& face : own.faces) {
    if (face.count(step) != 0) bytes += 8 + 2 * 4;  // what is behind, queueing it
  }
  return bytes + 3 * 4;  // queueing itself
}

// Leaf visits, and bytes moved with the labels' way out beside the least there is to move: masks
// and labels once, and labels copied out.
void countVisits(benchmark::State& state) {
  const Ball& solid = ball(static_cast<int>(state.range(0)));
  const std::vector<std::vector<sherd::Seed>> sets{solid.seeds};
  const std::vector<sherd::Labels> grown =
      sherd::grow(solid.blocks, sets, device(),
                  {.growth = sherd::Growth::flood, .keepCost = true, .outerSteps = 0});
  const std::size_t labels = std::size_t{3} * 1024 * solid.blocks->count();
  std::size_t visits = 0, bytes = 0;
  for (auto _ : state) {
    const std::vector<LeafSteps> leaves = leafSteps(*solid.blocks, grown.front());
    for (std::uint32_t leaf = 0; leaf < solid.blocks->count(); ++leaf) {
      visits += leaves[leaf].visited.size();
      for (const std::uint32_t step : leaves[leaf].visited) {
        bytes += visitBytes(*solid.blocks, leaves, leaf, step);
      }
    }
  }
  state.counters["leaves"] = static_cast<double>(solid.blocks->count());
  state.counters["visits"] = static_cast<double>(visits);
  state.counters["bytes"] = static_cast<double>(bytes + labels);
  state.counters["least"] = static_cast<double>(labels + 64 * solid.blocks->count());
}

// What the machine copies at best: all its threads, arrays that fit no cache.  Bytes are read and
// written ones.
void copyMemory(benchmark::State& state) {
  const std::size_t count = std::size_t{1} << 26;
  std::vector<std::uint64_t> from(count, 1), to(count, 2);
  for (auto _ : state) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, count / 64), [&](const auto& r) {
      std::copy(from.begin() + static_cast<std::ptrdiff_t>(r.begin()),
                from.begin() + static_cast<std::ptrdiff_t>(r.end()),
                to.begin() + static_cast<std::ptrdiff_t>(r.begin()));
    });
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                          static_cast<std::int64_t>(2 * count * sizeof(std::uint64_t)));
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
      {"flood, 26 neighbors", {.growth = Growth::flood, .neighborhood = 26}},
      {"nearest, kept", {.growth = Growth::nearest, .regrowIsolated = false}},
      {"nearest", {.growth = Growth::nearest}},
      {"euclid", {.growth = Growth::euclid}},
      {"chain", {.growth = Growth::chain}},
      {"euclid, grain", {.growth = Growth::euclid, .anisotropy = {{0, 0, 1}, 2.0}}},
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
    benchmark::DoNotOptimize(sherd::grow(solid.blocks, sets, device(state.range(2)), options));
  }
  state.SetLabel(std::string(way.name) + ", " + kDevices[static_cast<std::size_t>(state.range(2))]);
  report(state, solid);
}

// The same by splits, in as many pieces.
void growSplits(benchmark::State& state) {
  const Ball& solid = ball(static_cast<int>(state.range(0)));
  sherd::Device& on = device(state.range(1));
  const sherd::VoxelComponents components = sherd::findComponents(*solid.blocks, on);
  const sherd::SplitRun run{sherd::sharesOfSplits({}, solid.seeds.size(), 1), 1};
  const sherd::GrowOptions options{.growth = sherd::Growth::sequential, .outerSteps = 0};
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        sherd::growBySplits(solid.blocks, components, std::span(&run, 1), on, options));
  }
  state.SetLabel(std::string("sequential, ") + kDevices[static_cast<std::size_t>(state.range(1))]);
  report(state, solid);
}

BENCHMARK(growSplits)
    ->Name("grow/splits")
    ->ArgsProduct({{128, 256}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(growWay)
    ->Name("grow/way")
    ->ArgsProduct({{128, 256}, benchmark::CreateDenseRange(0, 7, 1), {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(growDevice)
    ->Name("grow/device")
    ->ArgsProduct({{128, 256, 512, 1024}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(growSerialQueue)
    ->Name("grow/serial_queue")
    ->Arg(128)
    ->Arg(256)
    ->Arg(512)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(growTwoStacks)
    ->Name("grow/two_stacks")
    ->Arg(128)
    ->Arg(256)
    ->Arg(512)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(countVisits)->Name("visits")->Arg(128)->Arg(256)->Arg(512)->Iterations(1);
BENCHMARK(copyMemory)->Name("copy")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
