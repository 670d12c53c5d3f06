// Fragments out of labels, beside OpenVDB's mesher alone on the same fragments.
//
// What a fragment must cost is a call of OpenVDB's mesher on its level set, and the files.
// Extraction makes the cut, the level sets, the meshes with what each face faces, volumes and
// contacts.  Run as grow_bench.cpp describes.
#include <benchmark/benchmark.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>
#include <tbb/parallel_for.h>

#include <filesystem>
#include <memory>
#include <string>

#include "shapes.h"
#include "voxelize/level_set_mesh.h"

namespace {

namespace fs = std::filesystem;

// A ball of 128 voxels in ten pieces.
const sherd::FractureResult& broken() {
  static const sherd::FractureResult result = [] {
    sherd::Device device("auto");
    return sherd::fracture(sherd::shapes::ball(1.0, 5),
                           {.pieces = 10, .seed = 3, .solid = {.resolution = 128}}, device);
  }();
  return result;
}

void extract(benchmark::State& state, sherd::Interface interface) {
  const sherd::FractureResult& result = broken();
  for (auto _ : state) {
    benchmark::DoNotOptimize(sherd::extractFragments(result.solid, result.labels,
                                                     {.surface = {.interface = interface}}));
  }
}

void bareMeshes(benchmark::State& state) {
  const sherd::FractureResult& result = broken();
  for (auto _ : state) {
    tbb::parallel_for(std::size_t{0}, result.fragments.size(), [&](std::size_t i) {
      benchmark::DoNotOptimize(sherd::meshInWorld(*result.fragments[i].surface));
    });
  }
}

void writeFiles(benchmark::State& state) {
  const sherd::FractureResult& result = broken();
  const fs::path folder = fs::temp_directory_path() / "sherd_extract_bench";
  fs::create_directories(folder);
  for (auto _ : state) {
    tbb::parallel_for(std::size_t{0}, result.fragments.size(), [&](std::size_t i) {
      const sherd::Fragment& fragment = result.fragments[i];
      const std::string name = std::to_string(i);
      sherd::writeVdb(folder / (name + ".vdb"), fragment, {"ball", 3});
      sherd::writePly(folder / (name + ".ply"), fragment.mesh);
    });
  }
  fs::remove_all(folder);
}

BENCHMARK_CAPTURE(extract, shared, sherd::Interface::shared)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(extract, independent, sherd::Interface::independent)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(bareMeshes)->Name("extract/bare_meshes")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(writeFiles)->Name("extract/write")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
