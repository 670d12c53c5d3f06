// The fragments of a folder, Sherd's or another program's.
#include <sherd/error.h>
#include <sherd/evaluate.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/input_error.h"
#include "io/manifest.h"
#include "io/natural_order.h"
#include "io/read_facing.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& manifest, const std::string& why) {
  inputError(manifest, "is damaged: " + why);
}

// A path; of several formats' the one that says what its faces face; empty where there are none.
std::string meshOf(const nlohmann::json& files) {
  const nlohmann::json mesh = files.value("mesh", nlohmann::json(""));
  if (!mesh.is_array()) return mesh.get<std::string>();
  for (const nlohmann::json& path : mesh) {
    if (path.get<std::string>().ends_with(".ply")) return path.get<std::string>();
  }
  return mesh.at(0).get<std::string>();
}

// A manifest is anybody's text: what it lacks is told, not crashed on.
EvaluatedFragment fragmentOf(const nlohmann::json& fragment) {
  EvaluatedFragment result;
  result.name = meshOf(fragment.at("files"));
  result.mesh.id = fragment.at("id").get<int>();
  result.share = fragment.at("share").get<double>();
  result.volume = fragment.at("volume").get<double>();
  result.area = fragment.at("area").get<double>();
  result.fractureArea = fragment.at("fracture_area").get<double>();
  result.contacts = fragment.at("contacts").size();
  return result;
}

FragmentSet listOf(const fs::path& file) {
  const nlohmann::json manifest = needManifest(file);
  const std::optional<std::vector<std::string>> listed = listedFiles(manifest);
  if (!listed) refuse(file, "its list of files is absent or leaves the folder");
  FragmentSet set;
  set.manifest = true;
  try {
    set.source = manifest.at("source").at("file").get<std::string>();
    set.seed = manifest.at("options").at("seed").get<std::uint64_t>();
    set.voxelSize = manifest.at("grid").at("voxel_size").get<double>();
    for (const nlohmann::json& fragment : manifest.at("fragments")) {
      set.fragments.push_back(fragmentOf(fragment));
    }
  } catch (const nlohmann::json::exception& e) {
    refuse(file, e.what());
  }
  if (set.fragments.empty()) refuse(file, "it has no fragment");
  for (const EvaluatedFragment& fragment : set.fragments) {
    const bool known = std::find(listed->begin(), listed->end(), fragment.name) != listed->end();
    if (!fragment.name.empty() && !known) {
      refuse(file, "fragment " + std::to_string(fragment.mesh.id) +
                       " has a mesh that is not in its files");
    }
  }
  return set;
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

FragmentSet readFragments(const fs::path& folder) {
  if (!fs::exists(folder)) inputError(folder, "no such folder; one of fragments is needed");
  if (!fs::is_directory(folder)) inputError(folder, "is a file; a folder of fragments is needed");
  const fs::path manifest = folder / "manifest.json";
  FragmentSet set = fs::exists(manifest) ? listOf(manifest) : meshesIn(folder);
  tbb::parallel_for(std::size_t{0}, set.fragments.size(), [&](std::size_t i) {
    EvaluatedFragment& fragment = set.fragments[i];
    if (fragment.name.empty()) return;
    const fs::path file = folder / fragment.name;
    SourceMesh read = readMesh(file);
    fragment.droppedTriangles = read.degenerateTriangles;
    fragment.mesh.mesh = std::move(read.mesh);
    if (set.manifest) fragment.mesh.facing = readFacing(file, fragment.mesh.mesh);
  });
  return set;
}

}  // namespace sherd
