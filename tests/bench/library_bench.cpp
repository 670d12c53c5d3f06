// Fractures of a dataset run, whose solid and unbroken surface are there already, beside OpenVDB's
// mesher alone on the same fragments' level sets.
//
// SHERD_BENCH_MESH names a mesh, in place of a torus; it is broken into 2 to 10 pieces, once each.
// Run as grow_bench.cpp describes.
#include <benchmark/benchmark.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>

#include <cstdlib>
#include <vector>

#include "pipeline/fracture_stages.h"
#include "shapes.h"
#include "surface/mesh.h"

namespace {

struct Library {
  sherd::Device device{"auto"};
  sherd::PreparedSolid ready;
  std::vector<sherd::FractureOptions> options;
  std::vector<sherd::GrownFracture> grown;
};

const Library& library() {
  static const Library made = [] {
    Library library;
    const char* const file = std::getenv("SHERD_BENCH_MESH");
    const sherd::TriangleMesh mesh =
        file != nullptr ? sherd::readMesh(file).mesh : sherd::shapes::torus(10.0, 2.0);
    library.ready = sherd::prepared(sherd::voxelize(mesh, {.resolution = 128}), library.device);
    library.ready.surface = sherd::intactSurface(library.ready.solid);
    for (int pieces = 2; pieces <= 10; ++pieces) {
      sherd::FractureOptions options;
      options.pieces = pieces;
      options.seed = static_cast<std::uint64_t>(pieces);
      options.seeds.extraSeedsPerPiece = 2;
      library.options.push_back(options);
      library.grown.push_back(
          sherd::grow(library.ready, options, library.device, sherd::StageClock(), nullptr));
    }
    return library;
  }();
  return made;
}

void extracted(benchmark::State& state, bool levelSets) {
  for (auto _ : state) {
    for (std::size_t i = 0; i < library().grown.size(); ++i) {
      sherd::FractureOptions options = library().options[i];
      options.surface.levelSets = levelSets;
      benchmark::DoNotOptimize(sherd::extracted(library().grown[i], options, nullptr));
    }
  }
}

void bareMeshes(benchmark::State& state) {
  std::vector<sherd::FractureResult> results;
  for (std::size_t i = 0; i < library().grown.size(); ++i) {
    results.push_back(sherd::extracted(library().grown[i], library().options[i], nullptr));
  }
  for (auto _ : state) {
    for (const sherd::FractureResult& result : results) {
      for (const sherd::Fragment& fragment : result.fragments) {
        benchmark::DoNotOptimize(sherd::meshInWorld(*fragment.surface));
      }
    }
  }
}

BENCHMARK_CAPTURE(extracted, meshes, false)
    ->Name("library/extract")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(extracted, level_sets, true)
    ->Name("library/extract_level_sets")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(bareMeshes)->Name("library/bare_meshes")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
