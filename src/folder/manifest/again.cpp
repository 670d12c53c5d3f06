// What a fracture that is broken again takes from the earlier one's manifest.
#include "folder/manifest/again.h"

#include <sherd/folder.h>
#include <sherd/options.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "base/files/file_bytes.h"
#include "base/input_error.h"
#include "base/text/json_text.h"
#include "base/text/option_names.h"
#include "folder/manifest/read_manifest.h"
#include "options/record.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Ordered = nlohmann::ordered_json;

// Returns a value of a manifest as a part of another one's text; of one that is too large, null.
Ordered bounded(const Json& value) {
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() > kLargestHistoryOptions ? Ordered() : Ordered::parse(text);
}

bool isCount(const Json& value) {
  return value.is_number_unsigned() && value >= 1 && value <= kMaxFragments;
}

// Returns an entry of a history by its values in a manifest, each null if there is none; null if
// they are of no break.
Ordered breakOf(const Json& source, const Json& only, const Json& fragments, const Json& seed,
                const Json& options) {
  if (!isCount(fragments) || !seed.is_number_unsigned()) return {};
  Ordered entry = Ordered::object();
  const auto add = [&](const char* key, const Json& value, bool isValid) {
    if (!isValid) return;
    Ordered own = bounded(value);
    if (!own.is_null()) entry[key] = std::move(own);
  };
  add("source", source, source.is_object());
  add("only", only, only.is_array() && std::all_of(only.begin(), only.end(), isCount));
  entry["fragments"] = fragments.get<std::uint64_t>();
  entry["seed"] = seed.get<std::uint64_t>();
  add("options", options, options.is_object());
  return entry;
}

// Returns the break that made a fracture.
std::string breakOf(const Json& manifest) {
  const Json only = manifest.value("only", Json());
  const Json& options = manifest.at("options");
  return jsonText(breakOf(only.is_null() ? manifest.at("source") : Json(), only,
                          manifest.at("fragments").size(), options.at("seed"), options),
                  -1);
}

// The formats of files of one kind, by the endings of their names.
template <class Format, std::size_t N>
std::vector<Format> formatsOf(const std::vector<std::string>& files,
                              const char* const (&names)[N]) {
  std::vector<Format> formats;
  for (const std::string& file : files) {
    const std::string extension = fs::path(file).extension().string();
    for (std::size_t i = 0; i < N; ++i) {
      const auto format = static_cast<Format>(i);
      const bool isKnown = std::find(formats.begin(), formats.end(), format) != formats.end();
      if (!isKnown && extension == std::string(".") + names[i]) formats.push_back(format);
    }
  }
  return formats;
}

// Whether an STL file is text.
bool isText(const fs::path& stl) {
  std::ifstream file(stl, std::ios::binary);
  std::string start(5, '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  return file.gcount() == 5 && start == "solid";  // which none of our binary ones begins with
}

void setMeshFormats(WriteOptions& write, const fs::path& file, const Manifest& manifest) {
  const std::vector<std::string>& meshes = manifest.fragments.front().meshes;
  write.mesh = !meshes.empty();
  if (!write.mesh) return;
  auto formats = formatsOf<MeshFileFormat>(meshes, names::kMeshFileFormat);
  for (const std::string& mesh : meshes) {
    if (!mesh.ends_with(".stl") || !isText(listedFile(file, mesh))) continue;
    std::replace(formats.begin(), formats.end(), MeshFileFormat::stl, MeshFileFormat::stlText);
  }
  if (!formats.empty()) write.meshFormats = std::move(formats);
}

// Sets the files that a fracture has.
void setFiles(WriteOptions& write, const fs::path& file, const Manifest& manifest,
              const Json& json) {
  const std::set<std::string> all(manifest.files.begin(), manifest.files.end());
  std::vector<std::string> labels;
  std::copy_if(manifest.files.begin(), manifest.files.end(), std::back_inserter(labels),
               [](const std::string& name) { return name.starts_with("labels."); });
  write.labels = !labels.empty();
  if (write.labels) write.voxelFormats = formatsOf<VoxelFormat>(labels, names::kVoxelFormat);
  write.vdb = !manifest.fragments.front().vdb.empty() || !manifest.allVdb.empty();
  setMeshFormats(write, file, manifest);
  write.preview = all.contains("preview.png");
  write.seeds = all.contains("seeds.json");
  write.boundaries = all.contains("boundaries.obj");
  write.cost = false;
  write.solid = json.contains("solid");
  write.scene = all.contains("scene.glb");
  write.graph = all.contains("graph.json");
  write.houdini = all.contains("pieces.geo");
  write.viewer = all.contains("viewer.html");
  write.usd = json.contains("usd");
  if (write.usd) {
    write.usdFormats.clear();
    if (all.contains("scene.usda")) write.usdFormats.push_back(UsdFormat::usda);
    if (all.contains("scene.usdz") || write.usdFormats.empty()) {
      write.usdFormats.push_back(UsdFormat::usdz);
    }
  }
  write.proxy = std::any_of(all.begin(), all.end(),
                            [](const std::string& name) { return name.starts_with("proxies/"); });
}

// Drops what holds for the whole solid, or for places in it.
void dropOfWhole(FractureOptions& options) {
  const FractureOptions usual;
  options.pieces = usual.pieces;
  options.solid = usual.solid;
  options.seeds.impacts.clear();
  options.seeds.randomImpacts = 0;
  options.seeds.density = {};
  options.seeds.given.reset();
  options.guides.clear();
  options.erode = usual.erode;
  options.dropShare = options.missing = 0.0;
  // Fragments with exact surfaces get them again, and others do not.
  if (options.surface.surface == Surface::exact || options.surface.surface == Surface::smooth) {
    options.surface.surface = Surface::automatic;
  }
}

}  // namespace

BreakHistory historyAfter(const Json& manifest) {
  BreakHistory history;
  if (const auto found = manifest.find("history"); found != manifest.end() && found->is_array()) {
    for (const Json& entry : *found) {
      if (!entry.is_object()) continue;
      const auto value = [&](const char* key) { return entry.value(key, Json()); };
      const Ordered own = breakOf(value("source"), value("only"), value("fragments"), value("seed"),
                                  value("options"));
      if (own.is_object()) history.breaks.push_back(jsonText(own, -1));
    }
  }
  const Json omitted = manifest.value("history_omitted", Json(0));
  if (omitted.is_number_unsigned()) history.omitted = omitted.get<std::size_t>();
  history.breaks.push_back(breakOf(manifest));
  while (history.breaks.size() > kMostHistory) {
    history.breaks.erase(history.breaks.begin() + 1);
    ++history.omitted;
  }
  return history;
}

fs::path manifestIn(const fs::path& path) {
  return whatIsAt(path) == fs::file_type::directory ? path / kManifestName : path;
}

RunOptions inheritedOptions(const fs::path& path) {
  const fs::path file = manifestIn(path);
  Json json;
  const Manifest manifest = readManifest(file, json);
  RunOptions options;
  try {
    options = optionsRecorded(json.at("options"));
  } catch (const Error& e) {
    inputError(file, std::string("is damaged: ") + e.what());
  }
  options = inheritedOptions(std::move(options));
  setFiles(options.write, file, manifest, json);
  return options;
}

RunOptions inheritedOptions(RunOptions options) {
  ++options.fracture.seed;
  dropOfWhole(options.fracture);
  options.volume = {};
  options.recenter = false;
  options.write.sourceFaces = false;
  return options;
}

}  // namespace sherd
