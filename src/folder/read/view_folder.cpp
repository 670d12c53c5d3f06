// The viewer's page of a fracture that is read back.
#include <sherd/error.h>
#include <sherd/folder.h>
#include <sherd/seeds.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>

#include "base/cancel_flag.h"
#include "base/input_error.h"
#include "folder/files/viewer_file.h"
#include "folder/manifest/partial_folder.h"
#include "folder/manifest/read_manifest.h"
#include "viewer/page.h"

namespace sherd {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// ---- Figures.  readManifest has checked what it uses; of the rest what is not as expected is left
// out, as earlier versions did not write all of it.

double numberOf(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : std::nan("");
}

template <std::size_t kCount>
std::array<double, kCount> numbersOf(const Json& object, const char* key) {
  std::array<double, kCount> numbers;
  numbers.fill(std::nan(""));
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() != kCount) return numbers;
  for (std::size_t i = 0; i < kCount; ++i) {
    if ((*found)[i].is_number()) numbers[i] = (*found)[i].get<double>();
  }
  return numbers;
}

int idOf(const Json& object, const char* key) {
  const double id = numberOf(object, key);
  return id >= 0.0 && id <= kMaxFragments ? static_cast<int>(id) : 0;
}

std::vector<ViewerPiece::Contact> pieceContacts(const Json& fragment) {
  std::vector<ViewerPiece::Contact> contacts;
  for (const char* const key : {"contacts", "thin_contacts"}) {
    const auto found = fragment.find(key);
    if (found == fragment.end() || !found->is_array()) continue;
    for (const Json& contact : *found) {
      if (!contact.is_object()) continue;
      const int id = idOf(contact, "id");
      if (id > 0) contacts.push_back({id, numberOf(contact, "area")});
    }
  }
  std::stable_sort(contacts.begin(), contacts.end(),
                   [](const auto& a, const auto& b) { return a.fragment < b.fragment; });
  return contacts;
}

ViewerPiece pieceOf(const Json& json, bool isMissing) {
  ViewerPiece piece;
  piece.id = idOf(json, "id");
  piece.isMissing = isMissing;
  const auto voxels = json.find("voxels");
  if (voxels != json.end() && voxels->is_number_unsigned())
    piece.voxels = voxels->get<std::uint64_t>();
  piece.volume = numberOf(json, "volume");
  piece.share = numberOf(json, "share");
  piece.area = numberOf(json, "area");
  piece.fractureArea = numberOf(json, "fracture_area");
  const std::array<double, 3> centroid = numbersOf<3>(json, "centroid");
  piece.centroid = {centroid[0], centroid[1], centroid[2]};
  piece.inertia = numbersOf<6>(json, "inertia");
  piece.contacts = pieceContacts(json);
  piece.split = idOf(json, "split");
  return piece;
}

// ---- Meshes

/// The meshes of a fracture with what their attributes refer to.
struct ReadMeshes {
  std::deque<TriangleMesh> meshes;  ///< [fragments], then those of ghosts: addresses stay
  std::vector<ViewerScene::Material> materials;
  std::vector<Texture> textures;
};

// Returns the index of a texture, and keeps it if it is a new one.
int kept(std::vector<Texture>& textures, Texture&& texture) {
  for (std::size_t i = 0; i < textures.size(); ++i) {
    if (textures[i].bytes == texture.bytes) return static_cast<int>(i);
  }
  textures.push_back(std::move(texture));
  return static_cast<int>(textures.size()) - 1;
}

// Adds a mesh; the materials of all are those of the first, as one fracture has one table.
void add(ReadMeshes& all, SourceMesh&& source) {
  const std::vector<Material>& own = source.appearance.materials;
  int last = -1;  // base colors precede normal maps and the like
  for (const Material& material : own) last = std::max(last, material.texture);
  std::vector<int> number;
  for (int i = 0; i <= last; ++i) {
    number.push_back(
        kept(all.textures, std::move(source.appearance.textures[static_cast<std::size_t>(i)])));
  }
  for (std::size_t i = all.materials.size(); i < own.size(); ++i) {
    const bool isInside = own[i].name == "inside";
    const int texture = own[i].texture < 0 ? -1 : number[static_cast<std::size_t>(own[i].texture)];
    const glm::u8vec3 color = isInside ? kInsideColor : srgbFromLinear(own[i].color);
    all.materials.push_back({color, texture, isInside});
  }
  TriangleMesh& mesh = all.meshes.emplace_back(std::move(source.mesh));
  mesh.attributes.normals.clear();  // of vertices: means over both sides of a crack's edge
  mesh.isMerged = true;             // sharp edges are creases, also where triangles were merged
}

// Returns the mesh file with neighbors, else the first; empty if there is none.
std::string meshFileOf(const ManifestFragment& fragment) {
  for (const std::string& name : fragment.meshes) {
    if (name.ends_with(".ply")) return name;
  }
  return fragment.meshes.empty() ? "" : fragment.meshes.front();
}

std::uint64_t bytesToView(const TriangleMesh& mesh) {
  return mesh.vertices.size() * sizeof(glm::dvec3) +
         mesh.triangles.size() * (sizeof(glm::uvec3) + sizeof(std::array<glm::vec2, 3>));
}

ReadMeshes meshesOf(const fs::path& file, const Manifest& manifest, std::uint64_t maxMemory,
                    const Progress* progress) {
  constexpr std::size_t kAtOnce = 16;
  ReadMeshes all;
  const std::size_t count = manifest.fragments.size();
  for (std::size_t first = 0; first < count; first += kAtOnce) {
    reportProgress(progress, "read", static_cast<double>(first) / static_cast<double>(count));
    std::vector<SourceMesh> some(std::min(kAtOnce, count - first));
    tbb::parallel_for(std::size_t{0}, some.size(), [&](std::size_t i) {
      const std::string name = meshFileOf(manifest.fragments[first + i]);
      some[i] = readMesh(listedFile(file, name), {.maxMemory = maxMemory}, progress);
    });
    for (SourceMesh& source : some) {
      maxMemory -= std::min(maxMemory, bytesToView(source.mesh));
      add(all, std::move(source));
    }
  }
  return all;
}

// The faces towards each fragment that is withheld, from its side: all that is known of its shape.
std::map<int, TriangleMesh> ghostsOf(const std::deque<TriangleMesh>& meshes, int fragments) {
  std::map<int, TriangleMesh> ghosts;
  for (const TriangleMesh& mesh : meshes) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const int neighbor = mesh.neighborOf(t);
      if (neighbor <= fragments) continue;
      TriangleMesh& ghost = ghosts[neighbor];
      const auto first = static_cast<std::uint32_t>(ghost.vertices.size());
      for (const int k : {0, 2, 1}) ghost.vertices.push_back(mesh.vertices[mesh.triangles[t][k]]);
      ghost.triangles.emplace_back(first, first + 1, first + 2);
    }
  }
  return ghosts;
}

// Meshes of level sets, for a fracture without mesh files.
ReadMeshes levelSetsOf(const fs::path& folder, const ReadOptions& options) {
  ReadMeshes all;
  for (Fragment& fragment : readPieces(folder, options).fragments) {
    all.meshes.push_back(std::move(fragment.mesh));
  }
  return all;
}

void addPieces(ViewerScene& scene, const Json& json, ReadMeshes& all) {
  const Json& fragments = json.at("fragments");
  for (std::size_t i = 0; i < fragments.size() && i < all.meshes.size(); ++i) {
    ViewerPiece piece = pieceOf(fragments[i], false);
    piece.mesh = &all.meshes[i];
    piece.attributes = &piece.mesh->attributes;
    scene.pieces.push_back(std::move(piece));
  }
  const auto withheld = json.find("withheld");
  if (withheld == json.end() || !withheld->is_array()) return;
  std::map<int, TriangleMesh> ghosts = ghostsOf(all.meshes, static_cast<int>(scene.pieces.size()));
  for (const Json& fragment : *withheld) {
    if (!fragment.is_object()) continue;
    ViewerPiece piece = pieceOf(fragment, true);
    if (const auto found = ghosts.find(piece.id); found != ghosts.end()) {
      all.meshes.push_back(std::move(found->second));
      piece.mesh = &all.meshes.back();
      ghosts.erase(found);
    }
    scene.pieces.push_back(std::move(piece));
  }
}

}  // namespace

Viewer viewerOf(const fs::path& path, const ViewerOptions& viewer, const ReadOptions& options,
                const Progress* progress) {
  requireSettled(path);
  const fs::file_type type = whatIsAt(path);
  if (type == fs::file_type::not_found)
    inputError(path, "no such folder; one of a fracture is needed");
  const fs::path file = type == fs::file_type::directory ? path / kManifestName : path;
  if (whatIsAt(file) == fs::file_type::not_found) {
    inputError(path, "holds no manifest.json; a fracture's folder is needed");
  }
  Json json;
  const Manifest manifest = readManifest(file, json);
  const bool hasMeshes = std::ranges::none_of(
      manifest.fragments, [](const ManifestFragment& fragment) { return fragment.meshes.empty(); });
  ReadMeshes all = hasMeshes ? meshesOf(file, manifest, options.maxMemory, progress)
                             : levelSetsOf(file, options);
  ViewerScene scene;
  scene.title = manifest.source;
  const double density = numberOf(json.at("options"), "density");
  setCoordinates(scene, manifest.coordinates, density > 0.0 ? density : WriteOptions().density);
  if (!viewer.unit.empty()) scene.unit = viewer.unit;
  if (viewer.up != '\0') scene.up = viewer.up;
  scene.splitParents = manifest.splitParents;
  addPieces(scene, json, all);
  scene.materials = std::move(all.materials);
  scene.textures = std::move(all.textures);
  ViewerPage page = viewerPage(scene, viewer.maxBytes, progress);
  return {std::move(page.html), std::move(page.warnings)};
}

}  // namespace sherd
