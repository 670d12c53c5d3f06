// Reads a fracture from its folder.
#include <sherd/files.h>
#include <sherd/folder.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/files/file_bytes.h"
#include "base/files/sha256.h"
#include "base/input_error.h"
#include "base/memory.h"
#include "folder/manifest/again.h"
#include "folder/manifest/read_manifest.h"
#include "folder/read/fragment_meshes.h"
#include "folder/read/voxels_of_meshes.h"
#include "formats/voxels/vdb.h"
#include "formats/voxels/voxel_lookup.h"
#include "grow/fields/small_components.h"
#include "pipeline/memory_estimate.h"
#include "voxelize/distance.h"
#include "voxelize/region.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// Converts the labels of a voxel file to the leaves of the solid.
Labels labelsOn(const Solid& solid, const RunLengthVoxels& voxels, const Manifest& manifest,
                const fs::path& file) {
  const VoxelLookup lookup(voxels);
  Labels labels;
  labels.blocks = solid.blocks;
  labels.fragmentCount = static_cast<int>(manifest.fragments.size());
  labels.fragment.assign(solid.blocks->count() * 512, 0);
  solid.blocks->forEachInside([&](std::size_t voxel) {
    const std::uint16_t label = lookup.at(solid.blocks->voxelAt(voxel) - manifest.indexMin);
    if (label < 2 || label > labels.fragmentCount + 1) {
      inputError(file, "does not belong to the fragments' .vdb files beside it");
    }
    labels.fragment[voxel] = static_cast<std::uint16_t>(label - 1);
  });
  return labels;
}

// Returns the fracture's first voxel file in a format that keeps box and ids.
std::optional<fs::path> labelFile(const fs::path& file, const Manifest& manifest) {
  for (const char* name : {"labels.rle", "labels.npy", "labels.npz", "labels.qstack"}) {
    if (std::find(manifest.files.begin(), manifest.files.end(), name) != manifest.files.end()) {
      return listedFile(file, name);
    }
  }
  return {};
}

// The level sets are a stranger's: they are united voxel by voxel, and their inside tiles expanded.
void requireLevelSet(const fs::path& file, const openvdb::FloatGrid& level,
                     const openvdb::FloatGrid* before, std::uint64_t maxMemory) {
  if (!isSolidLevelSet(level)) {
    inputError(file,
               "is not the level set of a fragment: its voxels are no cubes, or its band is "
               "narrower than three of them");
  }
  if (before != nullptr) {
    const GridFrame own = frameOf(level), first = frameOf(*before);
    if (own.voxelSize != first.voxelSize || own.origin != first.origin)
      inputError(file, "has other voxels than the fragments before it");
  }
  const VoxelCounts counts = voxelsOf(level, 0.0, /*above=*/false);
  requireMemoryOfFile(file.string(), estimatedMemory(counts.surface, counts.inside), maxMemory);
}

// Takes what `.ply` has not of materials from other formats beside it.
void completeMaterials(JoinedMaterials& materials, const fs::path& file, const Manifest& manifest,
                       std::uint64_t maxMemory) {
  for (const char* const ending : {".glb", ".obj"}) {
    for (const ManifestFragment& fragment : manifest.fragments) {
      if (materials.isComplete()) return;
      for (const std::string& name : fragment.meshes) {
        if (!name.ends_with(ending) || name == meshWithNeighbors(fragment.meshes)) continue;
        materials.complete(readMesh(listedFile(file, name), {.maxMemory = maxMemory}).appearance);
      }
    }
  }
}

// Sets solid and labels by the fragments' level sets and the voxel file.
void readVoxelsOf(FinishedFracture& finished, const fs::path& file, const Manifest& manifest,
                  const fs::path& labels, const ReadOptions& options) {
  FloatGridPtr whole;
  for (const ManifestFragment& fragment : manifest.fragments) {
    FloatGridPtr level = readLevelSet(listedFile(file, fragment.vdb), options);
    requireLevelSet(listedFile(file, fragment.vdb), *level, whole.get(), options.maxMemory);
    if (whole) {
      unite(*whole, *level);
    } else {
      whole = std::move(level);
    }
  }
  Solid& solid = finished.solid;
  solid.frame = frameOf(*whole);
  solid.blocks = std::make_shared<const LeafBlocks>(leafBlocks(*whole));
  solid.distance = std::move(whole);
  measureVoxels(solid);
  requireBox(file, solid);
  finished.labels = labelsOn(solid, readVoxels(labels, options).voxels, manifest, labels);
}

}  // namespace

FinishedFracture readFracture(const fs::path& path, const ReadOptions& options) {
  const fs::path file = manifestIn(path);
  nlohmann::json json;
  const Manifest manifest = readManifest(file, json);
  FinishedFracture finished;
  finished.resolution = manifest.resolution;
  finished.source.name = manifest.source;
  finished.source.stem = fs::path(manifest.source).stem().string();
  finished.source.sha256 = sha256(readFileBytes(file));
  finished.history = historyAfter(json);
  finished.history.sha256 = finished.source.sha256;
  finished.manifest = file;

  const std::optional<fs::path> labels = labelFile(file, manifest);
  const bool hasLevelSets = std::ranges::none_of(
      manifest.fragments, [](const ManifestFragment& fragment) { return fragment.vdb.empty(); });
  if (labels && hasLevelSets) {
    readVoxelsOf(finished, file, manifest, *labels, options);
  } else {
    setVoxelsOfMeshes(finished, file, manifest, options);
  }
  return finished;
}

void readFragmentMeshes(const fs::path& path, FinishedFracture& finished, std::uint64_t maxMemory) {
  const fs::path file = manifestIn(path);
  const Manifest manifest = readManifest(file);
  FragmentMeshes all;
  JoinedMaterials materials;
  bool hasVoxelFaces = false, isExact = false, hasNeighbors = true;
  for (const ManifestFragment& fragment : manifest.fragments) {
    hasVoxelFaces |= fragment.isOfVoxelFaces;
    isExact |= fragment.isExact;
    const std::string name = meshWithNeighbors(fragment.meshes);
    if (name.empty()) return;
    SourceMesh own = readMesh(listedFile(file, name), {.maxMemory = maxMemory});
    hasNeighbors &= !own.mesh.neighbor.empty();
    const std::vector<std::uint32_t> indices = materials.add(own.appearance);
    appendFragment(all, std::move(own), indices);
  }
  if (!hasNeighbors && !setNeighbors(all, finished.solid.frame, finished.labels)) return;
  completeMaterials(materials, file, manifest, maxMemory);
  all.appearance = std::move(materials).appearance();
  finished.source = originalSurface(all, std::move(finished.source), finished.sourceOf);
  all.faces.attributes = {};
  if (!hasVoxelFaces) finished.solid.region = regionOf(finished.solid, originalOf(all.faces));
  finished.faces = std::move(all.faces);
  finished.firstFace = std::move(all.firstFace);
  finished.isExact = isExact;
}

}  // namespace sherd
