// Reads the fragments of a folder, written by Sherd or another program.
#include <sherd/error.h>
#include <sherd/folder.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

#include "base/cancel_flag.h"
#include "base/input_error.h"
#include "base/text/natural_order.h"
#include "folder/manifest/partial_folder.h"
#include "folder/manifest/read_manifest.h"
#include "folder/read/fragment_meshes.h"
#include "folder/read/recorded_neighbors.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

FragmentSet listOf(const Manifest& manifest) {
  FragmentSet set;
  set.manifest = true;
  set.source = manifest.source;
  set.seed = manifest.seed;
  set.voxelSize = manifest.voxelSize;
  set.splitParents = manifest.splitParents;
  set.offset = manifest.offset;
  set.coordinates = manifest.coordinates;
  for (const ManifestFragment& fragment : manifest.fragments) {
    EvaluatedFragment& result = set.fragments.emplace_back();
    result.name = meshWithNeighbors(fragment.meshes);
    result.mesh.id = fragment.id;
    result.share = fragment.share;
    result.volume = fragment.volume;
    result.area = fragment.area;
    result.fractureArea = fragment.fractureArea;
    result.contacts = fragment.contacts;
    result.split = fragment.split;
  }
  return set;
}

std::uint64_t bytesOf(const TriangleMesh& mesh) {
  return mesh.vertices.size() * sizeof(glm::dvec3) + mesh.triangles.size() * sizeof(glm::uvec3);
}

// Subtracts, stopping at 0: a wrapped value would be no limit.
void takeFrom(std::atomic<std::uint64_t>& left, std::uint64_t bytes) {
  std::uint64_t before = left;
  while (!left.compare_exchange_weak(before, before - std::min(before, bytes))) {
  }
}

FragmentSet meshesIn(const fs::path& folder) {
  std::vector<std::string> names;
  bool folders = false;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const std::string name = at->path().filename().string();
    folders |= at->is_directory();
    if (at->is_regular_file() && !name.starts_with('.') && isMeshName(name)) names.push_back(name);
  }
  if (error) inputError(folder, "cannot be listed: " + error.message());
  if (names.empty()) {
    inputError(folder, std::string("holds neither manifest.json nor meshes of fragments; a "
                                   "fracture's folder is needed, or one of meshes") +
                           (folders ? " (try a folder in it)" : ""));
  }
  std::sort(names.begin(), names.end(), naturallyBefore);
  FragmentSet set;
  for (const std::string& name : names) {
    EvaluatedFragment& fragment = set.fragments.emplace_back();
    fragment.name = name;
    fragment.mesh.id = static_cast<int>(set.fragments.size());
  }
  return set;
}

}  // namespace

FragmentSet readFragments(const fs::path& folder, const ReadOptions& options,
                          const Progress* progress) {
  const fs::file_type type = whatIsAt(folder);
  if (type == fs::file_type::not_found) {
    inputError(folder, "no such folder; one of fragments is needed");
  }
  if (type != fs::file_type::directory) {
    inputError(folder, "is a file; a folder of fragments is needed");
  }
  requireSettled(folder);
  const fs::path manifest = folder / kManifestName;
  FragmentSet set = whatIsAt(manifest) == fs::file_type::not_found ? meshesIn(folder)
                                                                   : listOf(readManifest(manifest));
  std::atomic<std::uint64_t> left = options.maxMemory;
  tbb::parallel_for(std::size_t{0}, set.fragments.size(), [&](std::size_t i) {
    EvaluatedFragment& fragment = set.fragments[i];
    if (fragment.name.empty()) return;
    throwIfCancelled(progress);
    const fs::path file =
        set.manifest ? listedFile(manifest, fragment.name) : folder / fragment.name;
    SourceMesh read = readMesh(file, {.maxMemory = left});
    takeFrom(left, bytesOf(read.mesh));
    if (!set.manifest && i == 0) set.coordinates = read.coordinates;
    fragment.droppedTriangles = read.degenerateTriangles;
    fragment.mesh.mesh = std::move(read.mesh);
    fragment.mesh.mesh.attributes = {};
  });
  if (!set.manifest) keepAgreeingNeighbors(set);
  return set;
}

}  // namespace sherd
