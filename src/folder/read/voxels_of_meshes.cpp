// The voxels of a fracture that was written without them.
#include "folder/read/voxels_of_meshes.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/memory.h"
#include "folder/manifest/read_manifest.h"
#include "folder/read/fragment_meshes.h"
#include "formats/voxels/vdb.h"
#include "pipeline/memory_estimate.h"
#include "voxelize/distance.h"
#include "voxelize/leaves/leaf_blocks.h"
#include "voxelize/voxelize.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// Refuses a mesh that is too large for its voxels, before they are made.
void requireMemoryOf(const fs::path& file, const TriangleMesh& mesh, const Manifest& manifest,
                     std::uint64_t maxMemory) {
  FractureOptions options;
  options.solid.voxelSize = manifest.voxelSize;
  try {
    requireMemoryOfFile(file.string(), estimatedMemory(mesh, options), maxMemory);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::usage) throw;  // of a voxel size that the mesh cannot have
    inputError(file, std::string("does not fit the manifest beside it: ") + e.what());
  }
}

// Refuses a mesh beyond the manifest's grid, whose voxels may not even have numbers.
void requireWithin(const fs::path& file, const TriangleMesh& mesh, const GridFrame& frame,
                   const Manifest& manifest) {
  constexpr double kMost = 4.0;  // voxels that a smooth surface may lie outside
  const Box box = bounds(mesh);
  const glm::dvec3 low = frame.indexFromWorld(box.min), high = frame.indexFromWorld(box.max);
  for (int axis = 0; axis < 3; ++axis) {
    const double first = manifest.indexMin[axis], last = first + manifest.dims[axis];
    if (low[axis] >= first - kMost && high[axis] <= last + kMost) continue;
    inputError(file, "lies outside of the grid of the manifest beside it");
  }
}

// Gives the voxels of a fragment its id, unless they have one.  Returns whether any has it.
bool setLabels(Labels& labels, const LeafBlocks& fragment, std::uint16_t id) {
  bool isAny = false;
  fragment.forEachInside([&](std::size_t voxel) {
    const std::uint32_t leaf = findLeaf(*labels.blocks, fragment.origins[voxel / 512]);
    std::uint16_t& own = labels.fragment[std::size_t{leaf} * 512 + voxel % 512];
    if (own == 0) own = id;
    isAny |= own == id;
  });
  return isAny;
}

}  // namespace

void setVoxelsOfMeshes(FinishedFracture& finished, const fs::path& file, const Manifest& manifest,
                       const ReadOptions& options) {
  const glm::dvec3 first(manifest.indexMin.x(), manifest.indexMin.y(), manifest.indexMin.z());
  const GridFrame frame{manifest.origin - first * manifest.voxelSize, manifest.voxelSize};
  FloatGridPtr whole;
  std::vector<LeafBlocks> fragments;
  for (const ManifestFragment& fragment : manifest.fragments) {
    const std::string name = meshWithNeighbors(fragment.meshes);
    if (name.empty()) {
      inputError(file,
                 "the fracture was written with neither meshes nor .vdb files and labels of its "
                 "fragments, and one of both is needed");
    }
    const fs::path path = listedFile(file, name);
    const TriangleMesh mesh = readMesh(path, options).mesh;
    requireWithin(path, mesh, frame, manifest);
    requireMemoryOf(path, mesh, manifest, options.maxMemory);
    FloatGridPtr own = levelSetIn(mesh, frame);
    fragments.push_back(leafBlocks(*own));
    if (fragments.back().insideVoxels() == 0) {
      inputError(path, "has no voxel center inside; labels and .vdb files beside it are needed");
    }
    if (whole) {
      unite(*whole, *own);
    } else {
      whole = std::move(own);
    }
  }
  Solid& solid = finished.solid;
  solid.frame = frame;
  solid.blocks = std::make_shared<const LeafBlocks>(leafBlocks(*whole));
  solid.distance = std::move(whole);
  measureVoxels(solid);
  requireBox(file, solid);
  Labels& labels = finished.labels;
  labels.blocks = solid.blocks;
  labels.fragmentCount = static_cast<int>(fragments.size());
  labels.fragment.assign(solid.blocks->count() * 512, 0);
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    if (setLabels(labels, fragments[i], static_cast<std::uint16_t>(i + 1))) continue;
    inputError(file, "the mesh of fragment " + std::to_string(i + 1) +
                         " has no voxel that is not of another fragment");
  }
}

}  // namespace sherd
