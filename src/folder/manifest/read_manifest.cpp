// Reads manifest.json.
#include "folder/manifest/read_manifest.h"

#include <sherd/error.h>
#include <sherd/seeds.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "base/files/below_folder.h"
#include "base/files/parsed_json.h"
#include "base/input_error.h"
#include "base/text/option_names.h"
#include "folder/manifest/partial_folder.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double kAnyNumber = std::numeric_limits<double>::max();
constexpr double kFarthestVoxel = 1 << 30;  // so that differences fit in an int

[[noreturn]] void damaged(const std::string& what) {
  throw Error(ErrorCode::input, "is damaged: " + what);
}

// ---- Fields: `where` names the enclosing object in messages

const Json& field(const Json& object, const char* key, const std::string& where) {
  if (!object.is_object()) damaged(where + " is not an object");
  const auto found = object.find(key);
  if (found == object.end()) damaged(where + " has no \"" + key + "\"");
  return *found;
}

double numberIn(const Json& value, double low, double high, const std::string& what) {
  if (!value.is_number()) damaged(what + " is not a number");
  const double number = value.get<double>();
  if (!(number >= low && number <= high)) damaged(what + " is out of range: " + value.dump());
  return number;
}

double number(const Json& object, const char* key, double low, double high,
              const std::string& where) {
  return numberIn(field(object, key, where), low, high, where + "'s \"" + key + "\"");
}

int wholeIn(const Json& value, double low, double high, const std::string& what) {
  if (!value.is_number_integer()) damaged(what + " is not a whole number");
  return static_cast<int>(numberIn(value, low, high, what));
}

std::uint64_t count(const Json& object, const char* key, const std::string& where) {
  const Json& value = field(object, key, where);
  if (!value.is_number_unsigned()) damaged(where + "'s \"" + key + "\" is not a whole number");
  return value.get<std::uint64_t>();
}

std::string text(const Json& value, const std::string& what) {
  if (!value.is_string()) damaged(what + " is not text");
  return value.get<std::string>();
}

openvdb::Coord coordinates(const Json& object, const char* key, double low,
                           const std::string& where) {
  const Json& list = field(object, key, where);
  const std::string what = where + "'s \"" + key + "\"";
  if (!list.is_array() || list.size() != 3) damaged(what + " is not a list of three numbers");
  openvdb::Coord coordinates;
  for (int axis = 0; axis < 3; ++axis) {
    coordinates[axis] = wholeIn(list[static_cast<std::size_t>(axis)], low, kFarthestVoxel, what);
  }
  return coordinates;
}

glm::dvec3 vectorIn(const Json& list, const std::string& what) {
  if (!list.is_array() || list.size() != 3) damaged(what + " is not a list of three numbers");
  glm::dvec3 vector;
  for (int axis = 0; axis < 3; ++axis) {
    const Json& value = list[static_cast<std::size_t>(axis)];
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      damaged(what + " is not a list of three numbers");
    }
    vector[axis] = value.get<double>();
  }
  return vector;
}

// ---- Files

using Names = std::unordered_set<std::string>;

std::string listed(const Json& value, const Names& files, const std::string& what) {
  const std::string name = text(value, what);
  if (!files.contains(name)) damaged(what + " is not in its list of files");
  return name;
}

// Returns the files of one mesh: a path, or a list of one in each format.
std::vector<std::string> meshFiles(const Json& value, const Names& files, const std::string& what) {
  std::vector<std::string> paths;
  for (const Json& path : value.is_array() ? value : Json::array({value})) {
    paths.push_back(listed(path, files, what));
  }
  return paths;
}

// Returns the files of decimated meshes.
std::vector<std::vector<std::string>> decimatedIn(const Json& list, const Names& files,
                                                  const std::string& where) {
  if (!list.is_array()) damaged(where + "'s \"decimated\" is not a list");
  std::vector<std::vector<std::string>> meshes;
  for (const Json& mesh : list) {
    meshes.push_back(meshFiles(field(mesh, "file", where + "'s decimated mesh"), files,
                               where + "'s decimated mesh"));
    if (meshes.back().empty()) damaged(where + "'s decimated mesh has no file");
  }
  return meshes;
}

ManifestFragment fragmentOf(const Json& json, int id, const Names& files) {
  const std::string where = "fragment " + std::to_string(id);
  ManifestFragment fragment;
  if (wholeIn(field(json, "id", where), 1, kMaxFragments, where + "'s \"id\"") != id) {
    damaged(where + " has id " + field(json, "id", where).dump() + ", ids go up from 1 by 1");
  }
  fragment.id = id;
  fragment.voxels = count(json, "voxels", where);
  fragment.share = number(json, "share", 0.0, 1.0, where);
  fragment.volume = number(json, "volume", -kAnyNumber, kAnyNumber, where);
  fragment.area = number(json, "area", 0.0, kAnyNumber, where);
  fragment.fractureArea = number(json, "fracture_area", 0.0, kAnyNumber, where);
  const Json& contacts = field(json, "contacts", where);
  if (!contacts.is_array()) damaged(where + "'s \"contacts\" is not a list");
  const Json thin = json.value("thin_contacts", Json::array());
  if (!thin.is_array()) damaged(where + "'s \"thin_contacts\" is not a list");
  fragment.contacts = contacts.size() + thin.size();
  const std::string surface = text(field(json, "surface", where), where + "'s \"surface\"");
  fragment.isOfVoxelFaces = surface == names::of(names::kSurface, Surface::labels);
  fragment.isExact = surface == names::of(names::kSurface, Surface::exact);
  if (json.contains("split")) {
    fragment.split = wholeIn(json["split"], 0, kMaxFragments, where + "'s split");
  }
  const Json& own = field(json, "files", where);
  if (!own.is_object()) damaged(where + "'s \"files\" is not an object");
  if (const auto mesh = own.find("mesh"); mesh != own.end()) {
    fragment.meshes = meshFiles(*mesh, files, where + "'s mesh");
  }
  if (const auto list = json.find("decimated"); list != json.end()) {
    fragment.decimated = decimatedIn(*list, files, where);
  }
  if (const auto vdb = own.find("vdb"); vdb != own.end()) {
    fragment.vdb = listed(*vdb, files, where + "'s level set");
  }
  return fragment;
}

/// What coordinates mean.
CoordinateSystem coordinatesIn(const Json& json) {
  CoordinateSystem coordinates;
  const Json& source = json["source"];
  const auto basisOf = [](const Json& own) {
    const Json from = own.value("from", Json());
    for (const CoordinateBasis basis : {CoordinateBasis::file, CoordinateBasis::option}) {
      if (from == names::of(names::kCoordinateBasis, basis)) return basis;
    }
    return CoordinateBasis::format;
  };
  const Json& unit = field(source, "unit", "its source");
  coordinates.metersPerUnit =
      number(unit, "meters", std::numeric_limits<double>::min(), kAnyNumber, "its source's unit");
  coordinates.unitFrom = basisOf(unit);
  const Json& up = field(source, "up", "its source");
  const std::string axis =
      text(field(up, "axis", "its source's \"up\""), "the axis of its source's \"up\"");
  if (axis != "x" && axis != "y" && axis != "z") damaged("its source's \"up\" is not x, y or z");
  coordinates.up = axis.front();
  coordinates.upFrom = basisOf(up);
  return coordinates;
}

/// The bodies of the input that fragments have triangles of; fragments are read.
void readBodies(Manifest& manifest, const Json& json) {
  constexpr int kMostBodies = std::numeric_limits<int>::max();
  manifest.bodies = wholeIn(field(json["bodies"], "input", "its \"bodies\""), 1, kMostBodies,
                            "the number of its bodies");
  for (ManifestFragment& fragment : manifest.fragments) {
    const std::string where = "fragment " + std::to_string(fragment.id);
    const Json& own = json["fragments"][static_cast<std::size_t>(fragment.id - 1)];
    const Json& bodies = field(own, "bodies", where);
    if (!bodies.is_array()) damaged(where + "'s \"bodies\" is not a list");
    for (const Json& body : bodies) {
      const int least = fragment.bodies.empty() ? 0 : fragment.bodies.back() + 1;
      fragment.bodies.push_back(wholeIn(body, least, manifest.bodies - 1, "a body of " + where));
    }
  }
}

/// The splits that splits come from; fragments are read.
void readSplits(Manifest& manifest, const Json& splits) {
  if (!splits.is_array() || splits.size() > kMaxFragments) {
    damaged("its \"splits\" is not a list of at most " + std::to_string(kMaxFragments));
  }
  for (const Json& split : splits) {
    const auto before = static_cast<int>(manifest.splitParents.size());
    manifest.splitParents.push_back(
        wholeIn(field(split, "parent", "a split"), 0, before, "the parent of a split"));
  }
  for (const ManifestFragment& fragment : manifest.fragments) {
    if (fragment.split > static_cast<int>(manifest.splitParents.size())) {
      damaged("fragment " + std::to_string(fragment.id) + " comes from a split that is not listed");
    }
  }
}

}  // namespace

Manifest manifestOf(const Json& json) {
  if (!hasManifestSchema(json)) {
    throw Error(ErrorCode::input, std::string("is no manifest of a fracture; expected JSON with "
                                              "\"schema\": \"") +
                                      kManifestSchema + "\"");
  }
  Manifest manifest;
  const Json& grid = field(json, "grid", "it");
  manifest.source = text(field(field(json, "source", "it"), "file", "its source"), "its source");
  manifest.seed = count(field(json, "options", "it"), "seed", "its options");
  manifest.coordinates = coordinatesIn(json);
  manifest.resolution =
      wholeIn(field(grid, "resolution", "its grid"), 1, kFarthestVoxel, "its resolution");
  const Json& options = field(json, "options", "it");
  manifest.automatic = options.value("resolution", Json()) == kAutomatic;
  manifest.voxelSize =
      number(grid, "voxel_size", std::numeric_limits<double>::min(), kAnyNumber, "its grid");
  manifest.origin = vectorIn(field(grid, "origin", "its grid"), "its grid's \"origin\"");
  manifest.dims = coordinates(grid, "dims", 1, "its grid");
  manifest.indexMin = coordinates(grid, "index_min", -kFarthestVoxel, "its grid");
  manifest.solidVoxels = count(grid, "solid_voxels", "its grid");
  manifest.components = count(json, "components", "it");
  if (json.contains("offset")) manifest.offset = vectorIn(json["offset"], "its \"offset\"");
  std::optional<std::vector<std::string>> files = listedFiles(json);
  if (!files) damaged("its list of files is absent or leaves the folder");
  manifest.files = std::move(*files);
  const Names names(manifest.files.begin(), manifest.files.end());
  if (json.contains("vdb")) manifest.allVdb = listed(json["vdb"], names, "its \"vdb\"");
  const Json& fragments = field(json, "fragments", "it");
  if (!fragments.is_array() || fragments.empty() || fragments.size() > kMaxFragments) {
    damaged("its \"fragments\" is not a list of 1 to " + std::to_string(kMaxFragments));
  }
  for (const Json& fragment : fragments) {
    const int id = static_cast<int>(manifest.fragments.size()) + 1;
    manifest.fragments.push_back(fragmentOf(fragment, id, names));
  }
  if (json.contains("bodies")) readBodies(manifest, json);
  readSplits(manifest, json.value("splits", Json::array()));
  return manifest;
}

Manifest readManifest(const fs::path& file) {
  Json json;
  return readManifest(file, json);
}

Manifest readManifest(const fs::path& file, Json& json) {
  requireSettled(file);
  json = readManifestJson(file);
  try {
    return manifestOf(json);
  } catch (const Error& e) {
    inputError(file, e.what(), e.options());
  }
}

fs::path listedFile(const fs::path& manifest, const std::string& name) {
  const fs::path folder = manifest.has_parent_path() ? manifest.parent_path() : ".";
  if (!staysWithin(folder, name)) {
    inputError(manifest, "lists '" + name + "', which leaves the folder by a symbolic link");
  }
  return folder / name;
}

}  // namespace sherd
