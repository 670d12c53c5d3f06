// Reads volumes.
#include <sherd/error.h>
#include <sherd/files.h>
#include <sherd/fracture.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/cancel_flag.h"
#include "base/files/file_bytes.h"
#include "base/files/sha256.h"
#include "base/finite.h"
#include "base/input_error.h"
#include "base/memory.h"
#include "base/text/lower_case.h"
#include "formats/voxels/vdb.h"
#include "formats/voxels/voxel_faces.h"
#include "mesh/joined.h"
#include "pipeline/memory_estimate.h"
#include "voxelize/distance.h"
#include "voxelize/level_set_mesh.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

// Per two triangles of 12 bytes: six vertices of 24 bytes and the look-up of two edges.
constexpr std::uint64_t kBytesPerTriangle = 200;

bool isVdb(const fs::path& file) { return lowerCase(file.extension().string()) == ".vdb"; }

std::string namesOf(const std::vector<NamedGrid>& grids) {
  std::string names;
  for (const NamedGrid& grid : grids) names += (names.empty() ? "'" : ", '") + grid.name + "'";
  return names;
}

// Returns the grids of the volume: the one with the given name, all level sets, or the only grid.
std::vector<NamedGrid> chosenGrids(const fs::path& file, const VolumeOptions& options) {
  const std::string& name = options.grid;
  std::vector<NamedGrid> grids = readFloatGrids(file, {.maxMemory = options.maxMemory});
  if (!name.empty()) {
    const std::string all = namesOf(grids);
    std::erase_if(grids, [&](const NamedGrid& grid) { return grid.name != name; });
    if (grids.empty()) {
      inputError(file, "has no grid of floats named '" + name + "', but " + all);
    }
    grids.resize(1);
    return grids;
  }
  const bool hasLevelSet = std::any_of(grids.begin(), grids.end(),
                                       [](const NamedGrid& grid) { return grid.isLevelSet; });
  if (hasLevelSet) {
    std::erase_if(grids, [](const NamedGrid& grid) { return !grid.isLevelSet; });
  } else if (grids.size() > 1) {
    inputError(file, "holds several grids and no level set; choose one of " + namesOf(grids),
               OptionNames{"grid"});
  }
  return grids;
}

bool haveOneFrame(const std::vector<NamedGrid>& grids) {
  const GridFrame first = frameOf(*grids.front().grid);
  return std::all_of(grids.begin(), grids.end(), [&](const NamedGrid& grid) {
    const GridFrame frame = frameOf(*grid.grid);
    return frame.voxelSize == first.voxelSize && frame.origin == first.origin;
  });
}

double isovalueOf(const NamedGrid& grid, const VolumeOptions& options) {
  return grid.isLevelSet ? 0.0 : options.isovalue;
}

void readGrids(const fs::path& file, const VolumeOptions& options, Volume& volume,
               const Progress* progress) {
  std::vector<NamedGrid> grids = chosenGrids(file, options);
  for (const NamedGrid& grid : grids) requireFinite(file, grid);
  volume.voxelSize = smallestVoxel(*grids.front().grid);
  volume.isLevelSet = std::all_of(grids.begin(), grids.end(),
                                  [](const NamedGrid& grid) { return grid.isLevelSet; });
  for (const NamedGrid& grid : grids) volume.source.grids.push_back(grid.name);
  if (!volume.isLevelSet) volume.source.isovalue = options.isovalue;
  const bool keepsVoxels = options.ownVoxels && haveOneFrame(grids) &&
                           std::all_of(grids.begin(), grids.end(), [](const NamedGrid& grid) {
                             return isSolidLevelSet(*grid.grid);
                           });
  // A tile of a few bytes can represent any number of voxels, and its faces any number of
  // triangles.
  VoxelCounts counts;
  for (const NamedGrid& grid : grids) {
    const VoxelCounts own = voxelsOf(*grid.grid, isovalueOf(grid, options), !grid.isLevelSet);
    counts.inside += own.inside;
    counts.surface += own.surface;
  }
  requireMemoryOfFile(file.string() + " at its own voxels",
                      estimatedMemory(counts.surface, keepsVoxels ? counts.inside : 0.0),
                      options.maxMemory);
  if (!keepsVoxels) {
    for (const NamedGrid& grid : grids) {
      throwIfCancelled(progress);
      volume.source.mesh =
          joined(std::move(volume.source.mesh), meshInWorld(*grid.grid, isovalueOf(grid, options)));
    }
    if (!areFinite(volume.source.mesh.vertices))
      inputError(file, "has a transform that leads to positions that are not finite");
    return;
  }
  for (std::size_t i = 1; i < grids.size(); ++i) unite(*grids.front().grid, *grids[i].grid);
  volume.solid = solidOf(*grids.front().grid);
  requireBox(file, *volume.solid);
}

void readLabels(const fs::path& file, const VolumeOptions& options, Volume& volume,
                const Progress* progress) {
  const PlacedVoxels read = readVoxels(file, {.maxMemory = options.maxMemory});
  const openvdb::Coord& dims = read.voxels.dims;
  // A byte per voxel of a plane, and two planes of vertex numbers for their corners.
  requireMemory(
      file.string() + ": a plane of its voxels",
      9 * static_cast<std::uint64_t>(dims.y() + 1) * static_cast<std::uint64_t>(dims.z() + 1),
      options.maxMemory);
  const GridFrame frame = read.transform ? read.transform->frame : GridFrame{};
  volume.voxelSize = frame.voxelSize;
  const std::size_t most = std::min<std::uint64_t>(options.maxMemory / kBytesPerTriangle,
                                                   std::numeric_limits<std::uint32_t>::max() / 2);
  std::optional<TriangleMesh> faces = voxelFaces(read.voxels, frame, most, progress);
  if (!faces) {
    requireMemory(file.string() + ": the surface of its voxels", (most + 1) * kBytesPerTriangle, 0);
  }
  volume.source.mesh = std::move(*faces);
}

}  // namespace

bool isVolumeName(const fs::path& file) { return isVdb(file) || voxelFormatOf(file).has_value(); }

Volume readVolume(const fs::path& file, const VolumeOptions& options, const Progress* progress) {
  Volume volume;
  volume.source.name = file.filename().string();
  volume.source.stem = file.stem().string();
  if (isVdb(file)) {
    readGrids(file, options, volume, progress);
  } else {
    readLabels(file, options, volume, progress);
  }
  volume.source.sha256 = sha256OfFile(file);
  volume.source.fileVertices = volume.source.mesh.vertices.size();
  const bool isEmpty =
      volume.solid ? volume.solid->voxels == 0 : volume.source.mesh.triangles.empty();
  if (isEmpty) inputError(file, "nothing in it is solid");
  return volume;
}

}  // namespace sherd
