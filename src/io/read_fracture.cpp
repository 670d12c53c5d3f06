// A fracture's folder read back.
#include <sherd/io.h>
#include <sherd/refracture.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/input_error.h"
#include "io/manifest.h"
#include "io/sha256.h"
#include "io/vdb.h"
#include "mesh/file_bytes.h"
#include "voxelize/distance.h"
#include "voxelize/specks.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// The labels of a voxel file, on the leaves of the solid.
Labels labelsOn(const LeafBlocks& blocks, const VoxelLabels& voxels, const openvdb::Coord& first,
                int fragments, const fs::path& file) {
  Labels labels;
  labels.fragment.assign(blocks.count() * 512, 0);
  blocks.forEachInside([&](std::size_t place) {
    const openvdb::Coord at = blocks.voxelAt(place) - first;
    std::uint16_t label = 0;
    if (at.x() >= 0 && at.y() >= 0 && at.z() >= 0 && at.x() < voxels.dims.x() &&
        at.y() < voxels.dims.y() && at.z() < voxels.dims.z()) {
      const auto side = [&](int axis) { return static_cast<std::size_t>(voxels.dims[axis]); };
      label = voxels.labels[(static_cast<std::size_t>(at.x()) * side(1) +
                             static_cast<std::size_t>(at.y())) *
                                side(2) +
                            static_cast<std::size_t>(at.z())];
    }
    if (label < 2 || label > fragments + 1) {
      inputError(file, "does not belong to the fragments' .vdb files beside it");
    }
    labels.fragment[place] = static_cast<std::uint16_t>(label - 1);
  });
  return labels;
}

// The first voxel file of the fracture with its own box and ids.
std::optional<fs::path> labelFile(const fs::path& folder, const nlohmann::json& manifest) {
  const auto files = listedFiles(manifest);
  for (const char* name : {"labels.rle", "labels.npy", "labels.npz", "labels.qstack"}) {
    if (!files || std::find(files->begin(), files->end(), name) == files->end()) continue;
    if (fs::exists(folder / name)) return folder / name;
  }
  return {};
}

FinishedFracture read(const fs::path& file, const nlohmann::json& manifest) {
  FinishedFracture finished;
  const auto& grid = manifest.at("grid");
  const auto& fragments = manifest.at("fragments");
  const fs::path folder = file.parent_path();
  finished.fragments = static_cast<int>(fragments.size());
  finished.resolution = grid.at("resolution").get<int>();
  finished.source.name = manifest.at("source").at("file").get<std::string>();
  finished.source.stem = fs::path(finished.source.name).stem().string();
  finished.source.sha256 = sha256(readFileBytes(file));

  const std::optional<fs::path> labels = labelFile(folder, manifest);
  if (!labels) {
    inputError(file, "the fracture was written without labels.rle, .npy, .npz or .qstack");
  }
  FloatGridPtr whole;
  for (const auto& fragment : fragments) {
    if (!fragment.at("files").contains("vdb")) {
      inputError(file, "the fracture was written without .vdb files");
    }
    FloatGridPtr level = readLevelSet(folder / fragment.at("files").at("vdb").get<std::string>());
    if (whole) {
      unite(*whole, *level);
    } else {
      whole = std::move(level);
    }
  }
  if (!whole) inputError(file, "the fracture has no fragment");
  Solid& solid = finished.solid;
  solid.frame = frameOf(*whole);
  solid.blocks = leafBlocks(*whole);
  solid.distance = std::move(whole);
  measureVoxels(solid);

  const auto& min = grid.at("index_min");
  const openvdb::Coord first(min.at(0).get<int>(), min.at(1).get<int>(), min.at(2).get<int>());
  finished.labels = labelsOn(solid.blocks, expand(readVoxels(*labels).voxels), first,
                             finished.fragments, *labels);
  return finished;
}

}  // namespace

FinishedFracture readFracture(const fs::path& manifest) {
  try {
    return read(manifest, needManifest(manifest));
  } catch (const nlohmann::json::exception&) {
    inputError(manifest,
               "is damaged: a field that every fracture has is missing or of another kind");
  }
}

}  // namespace sherd
