// The objects of an assemblage: scaled, side by side, and voxelized.
#include "dataset/assemblage/parts.h"

#include <sherd/error.h>
#include <sherd/files.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "pipeline/fracture_stages.h"
#include "pipeline/memory_estimate.h"

namespace sherd {
namespace {

constexpr int kLeaf = 8;  // voxels along a leaf node

// Returns the voxels along the longest side of each object: one number for all, so that they have
// one voxel size.
int resolutionOfAll(const std::vector<LibraryObject>& objects,
                    const std::vector<SourceMesh>& sources, const SolidOptions& options) {
  if (options.resolution != kAutoResolution) return options.resolution;
  int most = kLeastAutoResolution;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    if (isVolumeName(objects[k].file)) continue;  // voxels resolve no thinner walls
    ofObject(objects[k].key,
             [&] { most = std::max(most, automaticResolution(sources[k].mesh, options)); });
  }
  return most;
}

// Scales the mesh of a part and moves its box to x along x, and to 0.
void place(TriangleMesh& mesh, double x, AssemblagePart& part) {
  const Box box = bounds(mesh);
  const double side = longestSide(box);
  if (!(std::isfinite(side) && std::isfinite(1.0 / side))) {
    throw Error(ErrorCode::input, "has no size that can be scaled to 1; scale it");
  }
  const glm::dvec3 begin(x, 0.0, 0.0);
  part.scale = 1.0 / side;
  part.translation = begin - box.min / side;
  part.size = (box.max - box.min) / side;
  for (glm::dvec3& v : mesh.vertices) v = (v - box.min) / side + begin;
}

// Returns the first whole leaf node beyond a solid and half a side.
int nextLeaf(int leaf, const Solid& solid, int resolution) {
  const int last = solid.blocks->origins.back().x() / kLeaf + 1;
  return leaf + last + (resolution / 2 + kLeaf - 1) / kLeaf + 1;
}

}  // namespace

void ofObject(const std::string& key, const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& e) {
    if (e.code() != ErrorCode::input && e.code() != ErrorCode::usage) throw;
    const std::string what = e.what();
    const std::string file = std::filesystem::path(key).filename().string();
    const bool isNamed = what.starts_with(file + ":");  // as in messages of readers
    const std::string named = isNamed ? key.substr(0, key.size() - file.size()) : key + ": ";
    throw Error(e.code(), named + what, e.options());
  }
}

std::vector<AssemblagePart> assemblageParts(const std::vector<LibraryObject>& objects,
                                            std::vector<SourceMesh> sources,
                                            const FractureOptions& base,
                                            const DatasetOptions& options, Device& device,
                                            const Progress* progress) {
  FractureOptions own = base;
  const int resolution = resolutionOfAll(objects, sources, base.solid);
  own.solid.resolution = kAutoResolution;
  own.solid.voxelSize = 1.0 / resolution;
  std::vector<AssemblagePart> parts;
  int leaf = 0;
  std::uint64_t memory = 0;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    AssemblagePart& part = parts.emplace_back();
    part.key = objects[k].key;
    part.sha256 = sources[k].sha256;
    TriangleMesh mesh = std::exchange(sources[k].mesh, {});
    mesh.attributes = {};
    ofObject(part.key, [&] {
      place(mesh, leaf * kLeaf * own.solid.voxelSize, part);
      requireMemory(mesh, own, options.maxMemory - std::min(memory, options.maxMemory));
      part.memory = estimatedMemory(mesh, own);
      memory += part.memory;
      own.solid.objects = sources[k].objectOfTriangle;
      part.ready = prepared(voxelize(mesh, own.solid, progress), device);
      leaf = nextLeaf(leaf, part.ready.solid, resolution);
    });
  }
  return parts;
}

}  // namespace sherd
