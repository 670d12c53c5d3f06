// A fracture in memory, as it is broken again.
#include <sherd/folder.h>

#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "folder/manifest/again.h"
#include "folder/manifest/manifest.h"
#include "folder/manifest/rounding.h"
#include "folder/read/fragment_meshes.h"
#include "voxelize/distance.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

std::span<const Fragment> keptOf(const FractureResult& result) {
  return {result.fragments.data(), result.kept()};
}

// Appends the meshes one after another, with the source's triangle of each face.
void setFaces(FinishedFracture& finished, std::span<const Fragment> fragments) {
  TriangleMesh& faces = finished.faces;
  finished.firstFace.assign(1, 0);
  for (const Fragment& fragment : fragments) {
    const auto first = static_cast<unsigned>(faces.vertices.size());
    const TriangleMesh& own = fragment.mesh;
    faces.vertices.insert(faces.vertices.end(), own.vertices.begin(), own.vertices.end());
    for (const glm::uvec3& triangle : own.triangles) faces.triangles.push_back(triangle + first);
    for (std::size_t t = 0; t < own.triangles.size(); ++t) {
      faces.neighbor.push_back(own.neighborOf(t));
      finished.sourceOf.push_back(own.source.empty() ? TriangleMesh::kNoSource : own.source[t]);
    }
    finished.firstFace.push_back(faces.triangles.size());
  }
}

// Returns the labels of the fragments that are kept, on the solid's leaves.
Labels labelsOfBlocks(const Solid& solid, const FractureResult& result) {
  Labels labels;
  labels.blocks = solid.blocks;
  labels.fragmentCount = static_cast<int>(result.kept());
  labels.fragment.assign(solid.blocks->count() * 512, 0);
  solid.blocks->forEachInside([&](std::size_t voxel) {
    const std::uint32_t leaf = findLeaf(*result.labels.blocks, solid.blocks->origins[voxel / 512]);
    labels.fragment[voxel] = result.labels.fragment[std::size_t{leaf} * 512 + voxel % 512];
  });
  return labels;
}

// Returns the solid of the fragments that are kept, by their level sets.
Solid unitedSolid(std::span<const Fragment> fragments) {
  FloatGridPtr all = copyOf(*fragments.front().surface);
  for (const Fragment& fragment : fragments.subspan(1)) unite(*all, *copyOf(*fragment.surface));
  Solid solid;
  solid.frame = frameOf(*all);
  solid.blocks = std::make_shared<const LeafBlocks>(leafBlocks(*all));
  solid.distance = std::move(all);
  measureVoxels(solid);
  return solid;
}

}  // namespace

FinishedFracture finishedFracture(const SourceMesh& source, const FractureOptions& options,
                                  const FractureResult& result, const WriteOptions& write) {
  FinishedFracture finished;
  finished.source = source;
  finished.isExact = isExact(options, result);
  finished.resolution = resolutionUsed(source, options, result.solid);
  nlohmann::json manifest = breakJson(source, options, result, write);
  manifest["fragments"] = std::vector<int>(result.kept());
  finished.history = historyAfter(manifest);
  const std::span<const Fragment> fragments = keptOf(result);
  setFaces(finished, fragments);
  finished.solid = unitedSolid(fragments);
  if (options.surface.surface != Surface::labels) {
    finished.solid.region = regionOf(finished.solid, originalOf(finished.faces));
  }
  finished.labels = labelsOfBlocks(finished.solid, result);
  return finished;
}

}  // namespace sherd
