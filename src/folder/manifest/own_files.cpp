// Selects the files in a manifest's list that have names of fracture files.
#include "folder/manifest/own_files.h"

#include <sherd/seeds.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <unordered_set>

#include "folder/manifest/file_names.h"
#include "folder/manifest/listed_files.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Names = std::unordered_set<std::string>;

// Returns the listed file at a JSON pointer, the first one of a list; empty if there is none.
std::string fileAt(const Json& manifest, const std::string& pointer, const Names& listed) {
  for (const char* item : {"", "/0"}) {
    const Json::json_pointer at(pointer + item);
    if (!manifest.contains(at) || !manifest[at].is_string()) continue;
    std::string file = manifest[at].get<std::string>();
    if (listed.contains(file)) return file;
  }
  return {};
}

std::size_t fragmentsOf(const Json& manifest) {
  const auto found = manifest.find("fragments");
  const bool isList = found != manifest.end() && found->is_array();
  return isList ? std::min<std::size_t>(found->size(), kMaxFragments) : 0;
}

// Returns the part of file names before a fragment's number, which the manifest does not record;
// empty if no file name has one.
std::string stemOf(const Json& manifest, std::size_t fragments, const Names& listed) {
  if (fragments > 0) {
    const std::string number = fragmentName("", 1, fragments);
    for (const char* kind : {"vdb", "mesh", "points", "sdf", "proxy"}) {
      const std::string file = fileAt(manifest, std::string("/fragments/0/files/") + kind, listed);
      std::string stem = fs::path(file).stem().string();
      if (stem.size() <= number.size() || !stem.ends_with(number)) continue;
      return stem.substr(0, stem.size() - number.size());
    }
  }
  for (const char* whole : {"/solid/vdb", "/solid/mesh", "/sdf"}) {
    const std::string file = fileAt(manifest, whole, listed);
    if (!file.empty()) return fs::path(file).stem().string();
  }
  return {};
}

// Options with every file in every format; text and binary .stl files have the same names.
WriteOptions everything() {
  WriteOptions write;
  write.seeds = write.boundaries = write.cost = write.solid = write.scene = write.graph = true;
  write.proxy = write.viewer = write.usd = write.houdini = true;
  write.vdbFiles = VdbFiles::both;
  write.usdFormats = {UsdFormat::usda, UsdFormat::usdz};
  write.voxelFormats = {VoxelFormat::rle, VoxelFormat::npy,    VoxelFormat::npz,
                        VoxelFormat::vox, VoxelFormat::qstack, VoxelFormat::bing};
  write.meshFormats = {MeshFileFormat::ply, MeshFileFormat::obj, MeshFileFormat::glb,
                       MeshFileFormat::stl, MeshFileFormat::binm};
  write.points.count = 1;
  write.pointFormats = {PointFormat::ply, PointFormat::xyz, PointFormat::npz, PointFormat::binp};
  write.distances.count = 1;
  write.correspondences = 1;
  return write;
}

// Removes "_t" and the number of triangles from a decimated mesh's name; empty for other names.
std::string withoutTriangles(const std::string& name) {
  const std::size_t ending = name.rfind('.');
  if (ending == std::string::npos) return {};
  std::size_t digits = ending;
  while (digits > 0 && std::isdigit(static_cast<unsigned char>(name[digits - 1]))) --digits;
  if (digits == ending || digits < 2 || name.compare(digits - 2, 2, "_t") != 0) return {};
  return name.substr(0, digits - 2) + name.substr(ending);
}

// The names of all files that a fracture with this stem can have.
class PossibleNames {
 public:
  ///   hasTextures  whatever the stem is
  PossibleNames(const std::string& stem, std::size_t fragments, bool hasTextures)
      : hasTextures_(hasTextures || (!stem.empty() && fragments > 0)) {
    SourceMesh source;
    source.stem = stem;
    const FractureFiles files = fileNames(source, fragments, {}, {}, everything());
    for (std::string& name : files.all()) {
      const bool ofStem = name.find('/') != std::string::npos;
      if (!stem.empty() || !ofStem) all_.insert(std::move(name));
    }
    if (stem.empty()) return;
    for (const std::vector<std::string>& ofOne : files.mesh) {
      meshes_.insert(ofOne.begin(), ofOne.end());
    }
  }

  bool contains(const std::string& name) const {
    const std::string plain = withoutTriangles(name);
    if (all_.contains(name) || (plain == "pieces.geo" && all_.contains(plain))) return true;
    return (hasTextures_ && isTexture(name)) || meshes_.contains(plain);
  }

 private:
  static bool isTexture(const std::string& name) {
    constexpr std::string_view kBeside = "meshes/";
    return name.starts_with(kBeside) && isTextureName(name.substr(kBeside.size()));
  }

  const bool hasTextures_;
  Names all_, meshes_;
};

}  // namespace

std::optional<OwnFiles> ownFiles(const Json& manifest) {
  const std::optional<std::vector<std::string>> files = listedFiles(manifest);
  if (!files) return {};
  const std::size_t fragments = fragmentsOf(manifest);
  Names listed(files->begin(), files->end());
  std::string stem = stemOf(manifest, fragments, listed);
  if (safeName(stem, "") != stem) stem.clear();
  const PossibleNames possible(stem, fragments, listed.contains("scene.usda"));
  OwnFiles result;
  for (const std::string& file : *files) {
    if (listed.erase(file) == 0) continue;  // a duplicate
    (possible.contains(file) ? result.own : result.others).push_back(file);
  }
  return result;
}

}  // namespace sherd
