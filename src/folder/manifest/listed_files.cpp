// The files that a manifest lists.
#include "folder/manifest/listed_files.h"

#include <sherd/error.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/files/below_folder.h"
#include "base/files/parsed_json.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kKind = "manifest of a fracture";
constexpr std::uintmax_t kLargestFile = std::uintmax_t{1}
                                        << 30;  // 65,534 fragments take a third of it

// Whether a name is valid for a fracture's file: not the manifest, and not in kPartialName.
bool isFractureFile(const std::string& name) {
  return isBelowFolder(name) && name != kManifestName && *fs::path(name).begin() != kPartialName;
}

}  // namespace

Json readManifestJson(const fs::path& file) { return readJson(file, kKind, kLargestFile); }

bool hasManifestSchema(const Json& json) {
  return json.is_object() && json.value("schema", Json()) == kManifestSchema;
}

std::optional<std::vector<std::string>> listedFiles(const Json& manifest) {
  const auto found = manifest.find("files");
  if (found == manifest.end() || !found->is_array()) return {};
  std::vector<std::string> files;
  for (const Json& entry : *found) {
    if (!entry.is_string() || !isFractureFile(entry.get_ref<const std::string&>())) return {};
    files.push_back(entry.get<std::string>());
  }
  return files;
}

std::optional<Json> manifestJson(const fs::path& file) {
  std::error_code none;
  if (!fs::is_regular_file(fs::symlink_status(file, none))) return {};
  try {
    Json json = readManifestJson(file);
    if (!hasManifestSchema(json)) return {};
    return json;
  } catch (const Error&) {
    return {};
  }
}

std::optional<fs::path> manifestListing(const fs::path& file) {
  for (fs::path folder = file.parent_path();; folder = folder.parent_path()) {
    const fs::path manifest = folder / kManifestName;
    if (const auto json = manifestJson(manifest)) {
      const std::string name = file.lexically_relative(folder).generic_string();
      const std::optional<std::vector<std::string>> files = listedFiles(*json);
      if (name == kManifestName ||
          (files && std::find(files->begin(), files->end(), name) != files->end())) {
        return manifest;
      }
    }
    if (folder == folder.parent_path()) return {};
  }
}

}  // namespace sherd
