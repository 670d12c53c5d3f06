// Reads densities from an attribute of a mesh, or from a grid.
#include <sherd/error.h>
#include <sherd/files.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "base/input_error.h"
#include "base/text/density_source.h"
#include "formats/mesh_files/read_mesh.h"
#include "formats/voxels/vdb.h"
#include "seed/draw/density.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

std::shared_ptr<const DensityField> fieldOfGrid(const DensitySource& source,
                                                const ReadOptions& options,
                                                const Progress* progress) {
  std::vector<NamedGrid> grids = readFloatGrids(source.file, options);
  std::string all;
  for (const NamedGrid& grid : grids) all += (all.empty() ? "'" : ", '") + grid.name + "'";
  if (!source.name.empty()) {
    std::erase_if(grids, [&](const NamedGrid& grid) { return grid.name != source.name; });
    if (grids.empty()) {
      inputError(source.file, "has no grid of floats named '" + source.name + "', but " + all);
    }
  } else if (grids.size() > 1) {
    inputError(source.file, "holds several grids; name one after a colon, of " + all,
               OptionNames{"density-attribute"});
  }
  try {
    return gridDensity(grids.front().grid, progress);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::input) throw;
    inputError(source.file, e.what());
  }
}

std::shared_ptr<const DensityField> fieldOfMesh(const fs::path& mesh, const std::string& name,
                                                const ReadOptions& options,
                                                const Progress* progress) {
  const ValuedMesh read = readValuedMesh(mesh, name, options, progress);
  try {
    return surfaceDensity(read.mesh, read.values);
  } catch (const Error& e) {
    inputError(mesh, e.what());
  }
}

}  // namespace

Density readDensity(const std::string& source, const fs::path& mesh, const ReadOptions& options,
                    const Progress* progress) {
  const DensitySource parts = densitySourceOf(source);
  if (!parts.file.empty()) return {source, fieldOfGrid(parts, options, progress)};
  if (!isMeshName(mesh)) {
    throw Error(ErrorCode::usage,
                "an attribute of vertices belongs to a mesh, and the input is none; give a .vdb "
                "file of densities",
                OptionNames{"density-attribute"});
  }
  return {source, fieldOfMesh(mesh, parts.name, options, progress)};
}

}  // namespace sherd
