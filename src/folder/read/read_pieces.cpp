// Reads the fragments to render from a file or folder.
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <sherd/folder.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "base/input_error.h"
#include "base/memory.h"
#include "base/text/lower_case.h"
#include "base/uncancelled.h"
#include "folder/manifest/partial_folder.h"
#include "folder/manifest/read_manifest.h"
#include "formats/voxels/vdb.h"
#include "pipeline/memory_estimate.h"
#include "voxelize/distance.h"
#include "voxelize/level_set_mesh.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

Fragment fragmentOf(int id, TriangleMesh mesh) {
  Fragment fragment;
  fragment.id = id;
  fragment.mesh = std::move(mesh);
  fragment.mass = massProperties(fragment.mesh);
  return fragment;
}

// A tile of a few bytes can represent any number of voxels, and its faces any number of triangles.
TriangleMesh meshOf(const fs::path& file, const openvdb::FloatGrid& levelSet,
                    std::uint64_t maxMemory) {
  const VoxelCounts counts = voxelsOf(levelSet, 0.0, /*above=*/false);
  requireMemoryOfFile(file.string() + ": the surface of its voxels",
                      estimatedMemory(counts.surface, 0.0), maxMemory);
  return meshInWorld(levelSet);
}

std::vector<Fragment> fromLevelSets(const fs::path& file, const ReadOptions& options) {
  std::vector<Fragment> fragments;
  for (const NamedGrid& level : readLevelSets(file, options)) {
    fragments.push_back(fragmentOf(static_cast<int>(fragments.size()) + 1,
                                   meshOf(file, *level.grid, options.maxMemory)));
  }
  return fragments;
}

// For a fracture without meshes.
std::vector<Fragment> fromVolumes(const fs::path& folder, const ReadOptions& options) {
  const fs::path file = folder / kManifestName;
  const Manifest manifest = readManifest(file);
  if (!manifest.allVdb.empty()) return fromLevelSets(listedFile(file, manifest.allVdb), options);
  std::vector<fs::path> volumes;
  for (const ManifestFragment& fragment : manifest.fragments) {
    if (fragment.vdb.empty()) {
      inputError(file, "names neither meshes nor level sets of its fragments");
    }
    volumes.push_back(listedFile(file, fragment.vdb));
  }
  std::vector<Fragment> fragments(volumes.size());
  tbb::parallel_for(std::size_t{0}, fragments.size(), [&](std::size_t i) {
    uncancelled([&] {
      fragments[i] =
          fragmentOf(static_cast<int>(i) + 1,
                     meshOf(volumes[i], *readLevelSet(volumes[i], options), options.maxMemory));
    });
  });
  return fragments;
}

Pieces fromFolder(const fs::path& folder, const ReadOptions& options) {
  FragmentSet set = readFragments(folder, options);
  const bool hasMeshes = std::none_of(set.fragments.begin(), set.fragments.end(),
                                      [](const EvaluatedFragment& f) { return f.name.empty(); });
  if (!hasMeshes) return {fromVolumes(folder, options), set.coordinates};
  std::vector<Fragment> fragments;
  for (EvaluatedFragment& fragment : set.fragments) {
    fragments.push_back(fragmentOf(fragment.mesh.id, std::move(fragment.mesh.mesh)));
  }
  return {std::move(fragments), set.coordinates};
}

}  // namespace

CoordinateSystem coordinatesOfFile(const fs::path& file, const CoordinateSystem& read) {
  if (read.unitFrom != CoordinateBasis::format && read.upFrom != CoordinateBasis::format) {
    return read;
  }
  std::error_code error;
  const std::optional<fs::path> manifest = manifestListing(fs::absolute(file, error));
  if (!manifest) return read;
  try {
    return readManifest(*manifest).coordinates;
  } catch (const Error&) {  // damaged: the file can be read without it
    return read;
  }
}

Pieces readPieces(const fs::path& path, const ReadOptions& options) {
  requireSettled(path);
  const fs::file_type type = whatIsAt(path);
  if (type == fs::file_type::not_found) inputError(path, "no such file or folder");
  if (type == fs::file_type::directory) return fromFolder(path, options);
  const std::string extension = lowerCase(path.extension().string());
  if (extension == ".vdb") return {fromLevelSets(path, options), coordinatesOfFile(path, {})};
  if (extension == ".json") {
    (void)readManifest(path);
    const fs::path folder = path.parent_path();
    return fromFolder(folder.empty() ? "." : folder, options);
  }
  SourceMesh source = readMesh(path, options);
  Pieces pieces{{}, coordinatesOfFile(path, source.coordinates)};
  pieces.fragments.push_back(fragmentOf(1, std::move(source.mesh)));
  return pieces;
}

}  // namespace sherd
