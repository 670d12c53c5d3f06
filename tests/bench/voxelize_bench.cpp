// Solids from meshes, beside OpenVDB's meshToLevelSet on the same triangles.
//
// A torus of 128 voxels with more and more triangles, at most eighteen to a voxel of surface, and
// one of 512.  Run as grow_bench.cpp describes.
#include <benchmark/benchmark.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <sherd/solid.h>

#include <vector>

#include "shapes.h"

namespace {

sherd::SolidOptions options(const benchmark::State& state) {
  return {.resolution = static_cast<int>(state.range(1))};
}

sherd::TriangleMesh torus(const benchmark::State& state) {
  const int steps = static_cast<int>(state.range(0));
  return sherd::shapes::torus(10.0, 4.0, 2 * steps, steps);
}

void voxelize(benchmark::State& state) {
  const sherd::TriangleMesh mesh = torus(state);
  for (auto _ : state) {
    benchmark::DoNotOptimize(sherd::voxelize(mesh, options(state)));
  }
  state.counters["triangles"] = static_cast<double>(mesh.triangles.size());
}

void meshToLevelSet(benchmark::State& state) {
  const sherd::TriangleMesh mesh = torus(state);
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const glm::dvec3& v : mesh.vertices) points.emplace_back(v.x, v.y, v.z);
  for (const glm::uvec3& t : mesh.triangles) triangles.emplace_back(t.x, t.y, t.z);
  const double voxelSize = sherd::voxelSizeFor(mesh, options(state));
  const auto transform = openvdb::math::Transform::createLinearTransform(voxelSize);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, triangles, 3.0f));
  }
}

}  // namespace

// 2,400 triangles, 38,400, 614,400 and 1,350,000.
void sizes(benchmark::internal::Benchmark* bench) {
  for (const int steps : {24, 98, 392, 581}) bench->Args({steps, 128});
  bench->Args({581, 512})->UseRealTime()->Unit(benchmark::kMillisecond);
}
BENCHMARK(voxelize)->Apply(sizes);
BENCHMARK(meshToLevelSet)->Apply(sizes);
