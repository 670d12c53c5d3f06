// Fractures of a dataset run, whose solid and unbroken surface are there already, beside OpenVDB's
// mesher alone on the same fragments' level sets.
//
// The points of such fractures, a thousand of each fragment, are sampled with and without meshes,
// in a pipeline like that of a dataset, growth included.
//
// SHERD_BENCH_MESH names a mesh, in place of a torus; it is broken into 2 to 10 pieces, once each.
// Run as grow_bench.cpp describes.
#include <benchmark/benchmark.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>
#include <sherd/points.h>

#include <cstdlib>
#include <memory>
#include <vector>

#include "grown_pipeline.h"
#include "pipeline/fracture_stages.h"
#include "shapes.h"
#include "voxelize/level_set_mesh.h"

namespace {

sherd::TriangleMesh benchMesh() {
  const char* const file = std::getenv("SHERD_BENCH_MESH");
  return file != nullptr ? sherd::readMesh(file).mesh : sherd::shapes::torus(10.0, 2.0);
}

struct Library {
  sherd::Device device{"auto"};
  sherd::PreparedSolid ready;
  std::vector<sherd::FractureOptions> options;
  std::vector<sherd::GrownFracture> grown;
};

const Library& library() {
  static const Library made = [] {
    Library library;
    library.ready =
        sherd::prepared(sherd::voxelize(benchMesh(), {.resolution = 128}), library.device);
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

std::vector<sherd::SurfacePoints> pointsOfMeshes(const sherd::GrownFracture& grown,
                                                 const sherd::PointOptions& points) {
  sherd::FractureOptions options;
  options.surface.levelSets = false;
  std::vector<sherd::SurfacePoints> all;
  for (const sherd::Fragment& fragment : sherd::extracted(grown, options, nullptr).fragments) {
    all.push_back(sherd::samplePoints(fragment.mesh, points));
  }
  return all;
}

enum class Sampled { nothing, surfaces, meshes };

void points(benchmark::State& state, Sampled sampled) {
  sherd::Device device("auto");
  sherd::PreparedSolid ready = sherd::prepared(
      sherd::voxelize(benchMesh(), {.resolution = static_cast<int>(state.range(0))}), device);
  ready.surface = sherd::intactSurface(ready.solid);
  constexpr std::size_t kFractures = 90;
  std::size_t fragments = 0;
  const auto sample = [&](const sherd::GrownFracture& grown) {
    const sherd::PointOptions options{.count = 1000};
    if (sampled == Sampled::meshes) {
      benchmark::DoNotOptimize(pointsOfMeshes(grown, options));
    } else if (sampled == Sampled::surfaces) {
      benchmark::DoNotOptimize(sherd::samplePoints(grown.result.solid, grown.result.labels,
                                                   {options, nullptr, ready.surface}));
    }
  };
  for (auto _ : state) fragments += sherd::forEachGrown(ready, kFractures, device, nullptr, sample);
  state.counters["fragments"] =
      benchmark::Counter(static_cast<double>(fragments), benchmark::Counter::kIsRate);
}

void atTwoResolutions(benchmark::internal::Benchmark* bench) {
  bench->Arg(64)->Arg(128)->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK_CAPTURE(points, none, Sampled::nothing)->Name("library/grow")->Apply(atTwoResolutions);
BENCHMARK_CAPTURE(points, without_meshes, Sampled::surfaces)
    ->Name("library/points")
    ->Apply(atTwoResolutions);
BENCHMARK_CAPTURE(points, of_meshes, Sampled::meshes)
    ->Name("library/points_of_meshes")
    ->Apply(atTwoResolutions);
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
