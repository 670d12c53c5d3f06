// The kernels under ThreadSanitizer, compiled with it (preset tsan): every way of growing, on
// threads of the C++ library, as TBB is not built for it.
//
// usage: sherd_kernel_races [planted]    planted: a kernel with a race instead, which must be
// reported
#include <sherd/labels.h>

#include <cstdio>
#include <iterator>
#include <string_view>
#include <thread>
#include <utility>

#include "cl/builtin_device.h"
#include "grow/sized/split_plan.h"
#include "grow/splits/sequential.h"
#include "kernels/voxel_shapes.h"

namespace sherd {

std::span<const NativeKernels> plantedKernels();  // cmake/CompileKernels.cmake

namespace {

constexpr std::size_t kThreads = 3;

void onPlainThreads(std::size_t items, const std::function<void(std::size_t)>& item) {
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (std::size_t i = t; i < items; i += kThreads) item(i);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

void onOneThread(std::size_t items, const std::function<void(std::size_t)>& item) {
  for (std::size_t i = 0; i < items; ++i) item(i);
}

std::unique_ptr<DeviceImpl> deviceOn(std::span<const NativeKernels> sets,
                                     const ForEachItem& threads) {
  for (const NativeKernels& kernels : sets) {
    DeviceFound found = describedBuiltin(kernels, std::uint64_t{1} << 32);
    if (!found.fault.empty()) continue;
    found.info.computeUnits = kThreads;
    return builtinDevice(found.info, kernels, threads);
  }
  throw Error(ErrorCode::device, "no kernels are compiled for this processor");
}

std::vector<GrowOptions> ways() {
  const Anisotropy grain{{1, 2, 3}, 1.5};
  return {{.growth = Growth::flood},
          {.growth = Growth::flood, .keepCost = true},
          {.growth = Growth::flood, .neighborhood = 26},
          {.growth = Growth::flood, .anisotropy = grain},
          {.growth = Growth::nearest},
          {.growth = Growth::chain},
          {.growth = Growth::euclid},
          {.growth = Growth::euclid, .roughness = 2.0, .noiseSeeds = {1, 2}}};
}

// Two fractures of a solid, which grow together: seeds on every so many inside voxels.
std::vector<std::vector<Seed>> seedSets(const voxel_shapes::VoxelSolid& solid) {
  std::vector<std::vector<Seed>> sets(2);
  std::size_t n = 0;
  for (const openvdb::Coord& voxel : solid.inside) {
    ++n;
    if (n % 97 == 1) sets[0].push_back({voxel, static_cast<std::uint16_t>(sets[0].size() + 1)});
    if (n % 411 == 3) sets[1].push_back({voxel, static_cast<std::uint16_t>(sets[1].size() + 1)});
  }
  return sets;
}

// The labels of two fractures by splits.
std::vector<std::vector<std::uint16_t>> labelsBySplits(
    const std::shared_ptr<const LeafBlocks>& blocks, Device& device) {
  const VoxelComponents components = findComponents(*blocks, device);
  std::vector<SplitRun> runs;
  for (const std::size_t further : {3, 20}) {
    runs.push_back({sharesOfSplits({}, components.count() + further, further), further});
  }
  std::vector<std::vector<std::uint16_t>> all;
  for (SeededLabels& grown :
       growBySplits(blocks, components, runs, device, {.growth = Growth::sequential})) {
    all.push_back(std::move(grown.labels.fragment));
  }
  return all;
}

bool sameEverywhere() {
  Device several = deviceOf(deviceOn(nativeKernels(), onPlainThreads));
  Device one = deviceOf(deviceOn(nativeKernels(), onOneThread));
  bool same = true;
  for (const auto& solid : {voxel_shapes::ball(12), voxel_shapes::sparseRandom(8, 45, 2)}) {
    const auto blocks = voxel_shapes::blocksOf(solid);
    const std::vector<std::vector<Seed>> sets = seedSets(solid);
    same = same && findComponents(*blocks, several).count() == findComponents(*blocks, one).count();
    for (const GrowOptions& options : ways()) {
      const std::vector<Labels> grown = grow(blocks, sets, several, options),
                                expected = grow(blocks, sets, one, options);
      for (std::size_t f = 0; f < sets.size(); ++f)
        same = same && grown[f].fragment == expected[f].fragment;
    }
    same = same && labelsBySplits(blocks, several) == labelsBySplits(blocks, one);
  }
  return same;
}

void race() {
  const std::unique_ptr<DeviceImpl> device = deviceOn(plantedKernels(), onPlainThreads);
  const DeviceBuffer sum = uploadBuffer<std::uint32_t>(*device, std::vector<std::uint32_t>(1, 0));
  launchKernel(*device, "planted", 64, 1, sum);
}

}  // namespace
}  // namespace sherd

int main(int count, char** arguments) {
  if (count > 1 && std::string_view(arguments[1]) == "planted") {
    sherd::race();
    return 0;
  }
  const bool same = sherd::sameEverywhere();
  std::puts(same ? "every growth gives the same on one thread and on three"
                 : "a growth differs between one thread and three");
  return same ? 0 : 1;
}
