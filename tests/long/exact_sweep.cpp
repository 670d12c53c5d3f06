// Fractures of random shapes and of real meshes with Surface::exact, each checked.
//
// usage: sherd_exact_sweep COUNT SEED [MESH...]    (SHERD_TEST_DATA's closed meshes, by default)
//
// Prints the share of fall-backs by class of input, their reasons and all faults; ends with status
// 1 where there is a fault.
#include <openvdb/openvdb.h>
#include <sherd/sherd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "exact/self_crossings.h"
#include "exact_checks.h"
#include "mesh/repair.h"
#include "shapes.h"

namespace {

using namespace sherd;

// A mesh as exact surfaces cut it.
struct Input {
  std::string name;
  TriangleMesh mesh;
  TriangleMesh clean;  // repaired
  bool crossesItself = false;
};

Input inputOf(std::string name, TriangleMesh mesh) {
  Input input{std::move(name), std::move(mesh), {}};
  const Repaired repair = repaired(input.mesh);
  input.clean = {input.mesh.vertices, input.mesh.triangles};
  for (std::size_t t = 0; t < repair.source.size(); ++t) {
    input.clean.triangles[repair.source[t]] = repair.mesh.triangles[t];
  }
  input.crossesItself = !selfCrossings(repair.mesh.vertices, repair.mesh.triangles).empty();
  return input;
}

struct Tally {
  int runs = 0, fallBacks = 0, faults = 0;
  std::map<std::string, int> reasons;
};

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
int whole(std::mt19937_64& random, int low, int high) {
  return std::uniform_int_distribution<int>(low, high)(random);
}

TriangleMesh randomShape(std::mt19937_64& random, std::string& name) {
  switch (whole(random, 0, 5)) {
    case 0:
      name = "cube";
      return shapes::cube(uniform(random, 0.5, 3.0));
    case 1:
      name = "ball";
      return shapes::ball(1.0, whole(random, 1, 5));
    case 2:
      name = "torus";
      return shapes::torus(2.0, uniform(random, 0.2, 1.0), whole(random, 12, 96),
                           whole(random, 8, 48));
    case 3:
      name = "cup";
      return shapes::cup(1.0, uniform(random, 0.03, 0.3), uniform(random, 0.5, 3.0), 0.2,
                         whole(random, 8, 96));
    case 4:
      name = "hollow ball";
      return shapes::hollowBall(1.0, uniform(random, 0.3, 0.9), whole(random, 2, 4));
    default:
      name = "two parts";
      return shapes::append(shapes::ball(1.0, 3, {-1.5, 0, 0}), shapes::cube(1.2, {1, 0, 0}));
  }
}

FractureOptions randomOptions(std::mt19937_64& random) {
  FractureOptions options;
  options.surface = {.levelSets = false, .surface = Surface::exact};
  options.pieces = whole(random, 2, 30);
  options.seed = random();
  options.solid.resolution = whole(random, 4, 16) * 8;
  if (whole(random, 0, 2) == 0) options.grow.roughness = uniform(random, 0.3, 3.0);
  if (whole(random, 0, 3) == 0) options.seeds.extraSeedsPerPiece = 2;
  if (whole(random, 0, 5) == 0) options.grow.growth = Growth::flood;
  if (whole(random, 0, 5) == 0) options.grow.anisotropy = {{1, 2, 3}, uniform(random, -0.7, 3.0)};
  if (whole(random, 0, 5) == 0) options.erode.iterations = whole(random, 1, 3);
  return options;
}

std::string described(const FractureOptions& o) {
  return std::to_string(o.pieces) + " pieces, seed " + std::to_string(o.seed) + ", " +
         std::to_string(o.solid.resolution) + " voxels, roughness " +
         std::to_string(o.grow.roughness.voxels);
}

void breakOne(const Input& input, const FractureOptions& options, Device& device, Tally& tally) {
  ++tally.runs;
  const auto fault = [&](const std::string& what) {
    ++tally.faults;
    std::printf("FAULT %s (%s): %s\n", input.name.c_str(), described(options).c_str(),
                what.c_str());
  };
  try {
    const FractureResult result = fracture(input.mesh, options, device);
    if (!result.exactFailure.empty()) {
      ++tally.fallBacks;
      ++tally.reasons[result.exactFailure];
      return;
    }
    ExactFaults faults =
        exactFaults(input.clean, result.fragments, !options.erode.iterations.isZero());
    if (input.crossesItself) faults.selfCrossings = 0;
    if (faults.any()) fault(faults.text());
  } catch (const Error& e) {  // others are refusals
    if (e.code() == ErrorCode::internal) fault(e.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  openvdb::initialize();
  const int count = argc > 1 ? std::atoi(argv[1]) : 100;
  std::mt19937_64 random(argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1);
  std::vector<Input> meshes;
  for (int i = 3; i < argc; ++i) {
    meshes.push_back(
        inputOf(std::filesystem::path(argv[i]).filename().string(), readMesh(argv[i]).mesh));
  }
  Device device("builtin");
  std::map<std::string, Tally> tallies;
  for (int i = 0; i < count; ++i) {
    const FractureOptions options = randomOptions(random);
    if (!meshes.empty() && i % 2 == 0) {
      const Input& input =
          meshes[static_cast<std::size_t>(whole(random, 0, static_cast<int>(meshes.size()) - 1))];
      breakOne(input, options, device, tallies[input.name]);
    } else {
      std::string name;
      TriangleMesh shape = randomShape(random, name);
      breakOne(inputOf(name, std::move(shape)), options, device, tallies[name]);
    }
  }
  int faults = 0;
  for (const auto& [name, tally] : tallies) {
    faults += tally.faults;
    std::printf("%-28s %4d runs, %3d fall-backs, %d faults\n", name.c_str(), tally.runs,
                tally.fallBacks, tally.faults);
    for (const auto& [reason, n] : tally.reasons) std::printf("    %3d %s\n", n, reason.c_str());
  }
  return faults > 0 ? 1 : 0;
}
