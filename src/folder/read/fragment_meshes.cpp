// The meshes of a fracture's fragments with their surface attributes, read from their files.
#include "folder/read/fragment_meshes.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "base/chosen.h"
#include "cut/label_reader.h"
#include "formats/gltf/gltf_texture_uses.h"
#include "mesh/joined.h"
#include "mesh/positions.h"

namespace sherd {
namespace {

constexpr const char* kInsideName = "inside";

// Appends values, and defaults where one of the two arrays is absent.
//   before, more  how many values there are with the defaults
template <class Value>
void appendOr(std::vector<Value>& all, std::vector<Value> own, std::size_t before, std::size_t more,
              const Value& usual) {
  if (all.empty() && own.empty()) return;
  all.resize(before, usual);
  own.resize(more, usual);
  all.insert(all.end(), own.begin(), own.end());
}

// A triangle by its positions, the lowest first, and whose it is.
struct Side {
  std::array<std::uint32_t, 3> key{};
  std::uint16_t fragment = 0;
  bool operator<(const Side& other) const {
    return std::tie(key, fragment) < std::tie(other.key, other.fragment);
  }
};

std::array<std::uint32_t, 3> keyOf(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (b < a && b < c) return {b, c, a};
  if (c < a && c < b) return {c, a, b};
  return {a, b, c};
}

// Returns the fragment that has the voxels behind a face, 0 if they are outside.
std::uint16_t behind(const TriangleMesh& mesh, std::size_t t, std::uint16_t own,
                     const GridFrame& frame, LabelReader& labels) {
  const glm::uvec3& corner = mesh.triangles[t];
  const glm::dvec3 &a = mesh.vertices[corner.x], &b = mesh.vertices[corner.y],
                   &c = mesh.vertices[corner.z];
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  if (glm::length(normal) == 0.0) return 0;
  for (const double voxels : {0.5, 1.0, 1.5}) {
    const glm::dvec3 at = (a + b + c) / 3.0 + voxels * frame.voxelSize * glm::normalize(normal);
    const glm::ivec3 voxel(glm::round(frame.indexFromWorld(at)));
    const openvdb::Coord coord(voxel.x, voxel.y, voxel.z);
    if (!labels.isInside(coord)) continue;
    const std::uint16_t label = labels.at(coord);
    if (label != own) return label;
  }
  return 0;
}

// Which fragments have a vertex at a position.
class FragmentsAt {
 public:
  ///   at  of vertices, firstAtPosition
  FragmentsAt(const FragmentMeshes& all, const std::vector<std::uint32_t>& at) : at_(at) {
    for (std::size_t f = 0; f + 1 < all.firstFace.size(); ++f) {
      for (std::size_t t = all.firstFace[f]; t < all.firstFace[f + 1]; ++t) {
        for (int k = 0; k < 3; ++k)
          pairs_.emplace_back(at[all.faces.triangles[t][k]], static_cast<std::uint16_t>(f + 1));
      }
    }
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  }

  // Returns the other fragment that has vertices at most corners of a face, the first of several; 0
  // if none has one.
  [[nodiscard]] std::uint16_t most(const glm::uvec3& face, std::uint16_t own) const {
    std::map<std::uint16_t, int> counts;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t position = at_[face[k]];
      for (auto pair = std::lower_bound(pairs_.begin(), pairs_.end(), Pair{position, 0});
           pair != pairs_.end() && pair->first == position; ++pair) {
        if (pair->second != own) ++counts[pair->second];
      }
    }
    const auto found =
        std::max_element(counts.begin(), counts.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    return found == counts.end() ? std::uint16_t{0} : found->first;
  }

 private:
  using Pair = std::pair<std::uint32_t, std::uint16_t>;
  const std::vector<std::uint32_t>& at_;
  std::vector<Pair> pairs_;
};

}  // namespace

int JoinedMaterials::addTexture(const Texture& texture) {
  for (std::size_t i = 0; i < joined_.textures.size(); ++i) {
    const Texture& known = joined_.textures[i];
    // Files of other formats name the same image in other ways, or not at all.
    const bool isSame = !texture.bytes.empty() || known.name == texture.name;
    if (isSame && known.bytes == texture.bytes) return static_cast<int>(i);
  }
  joined_.textures.push_back(texture);
  return static_cast<int>(joined_.textures.size()) - 1;
}

Material JoinedMaterials::withTextures(Material material, const Appearance& other) {
  const auto known = [&](int texture) {
    return texture >= 0 && static_cast<std::size_t>(texture) < other.textures.size();
  };
  const auto added = [&](int texture) {
    return addTexture(other.textures[static_cast<std::size_t>(texture)]);
  };
  material.texture = known(material.texture) ? added(material.texture) : -1;
  if (material.gltf.empty()) return material;
  auto json = nlohmann::ordered_json::parse(material.gltf, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return material;
  forEachTextureUse(json, [&](nlohmann::ordered_json& use) {
    const auto& index = use["index"];
    if (!index.is_number_integer() || !known(index.get<int>())) return false;
    use["index"] = added(index.get<int>());
    return true;
  });
  material.gltf = json.dump();
  return material;
}

std::vector<std::uint32_t> JoinedMaterials::add(const Appearance& other) {
  std::vector<std::uint32_t> indices;
  for (const Material& material : other.materials) {
    if (material.name == kInsideName) {
      indices.push_back(kInside);
      continue;
    }
    const auto known = std::find_if(joined_.materials.begin(), joined_.materials.end(),
                                    [&](const Material& m) { return m.name == material.name; });
    indices.push_back(static_cast<std::uint32_t>(known - joined_.materials.begin()));
    if (known != joined_.materials.end()) continue;
    joined_.materials.push_back(withTextures(material, other));
    isCompleted_.push_back(false);
  }
  return indices;
}

void JoinedMaterials::complete(const Appearance& other) {
  for (std::size_t i = 0; i < joined_.materials.size(); ++i) {
    if (isCompleted_[i]) continue;
    for (const Material& material : other.materials) {
      if (material.name != joined_.materials[i].name) continue;
      joined_.materials[i] = withTextures(material, other);
      isCompleted_[i] = true;
      break;
    }
  }
}

bool JoinedMaterials::isComplete() const {
  return std::all_of(isCompleted_.begin(), isCompleted_.end(), [](bool is) { return is; });
}

void appendFragment(FragmentMeshes& all, SourceMesh own,
                    const std::vector<std::uint32_t>& materials) {
  SurfaceAttributes& to = all.faces.attributes;
  SurfaceAttributes& from = own.mesh.attributes;
  const std::size_t before = all.faces.triangles.size(), more = own.mesh.triangles.size();
  for (std::uint32_t& material : from.material) {
    material = material < materials.size() ? materials[material] : JoinedMaterials::kInside;
  }
  appendOr(to.texcoords, std::move(from.texcoords), before, more, {});
  appendOr(to.colors, std::move(from.colors), before, more,
           {kInsideColor, kInsideColor, kInsideColor});
  appendOr(to.material, std::move(from.material), before, more, JoinedMaterials::kInside);
  appendOr(to.normals, std::move(from.normals), before, more, {});
  // A triangle is a face of its own where a file has no polygons.
  const bool hasPolygons = !all.polygons.empty() || !own.polygons.empty();
  if (hasPolygons) {
    for (std::size_t t = all.polygons.size(); t < before; ++t) {
      all.polygons.push_back({static_cast<std::uint32_t>(t), {0, 1, 2}});
    }
    const std::uint32_t first = all.polygons.empty() ? 0 : all.polygons.back().polygon + 1;
    for (std::size_t t = 0; t < more; ++t) {
      PolygonPart part = own.polygons.empty()
                             ? PolygonPart{static_cast<std::uint32_t>(t), {0, 1, 2}}
                             : own.polygons[t];
      part.polygon += first;
      all.polygons.push_back(part);
    }
  }
  std::vector<std::uint16_t> neighbor = std::move(all.faces.neighbor);
  neighbor.insert(neighbor.end(), own.mesh.neighbor.begin(), own.mesh.neighbor.end());
  SurfaceAttributes attributes = std::move(to);
  all.faces = joined(std::move(all.faces), own.mesh);
  all.faces.neighbor = std::move(neighbor);
  all.faces.attributes = std::move(attributes);
  all.firstFace.push_back(all.faces.triangles.size());
}

bool setNeighbors(FragmentMeshes& all, const GridFrame& frame, const Labels& labels) {
  TriangleMesh& faces = all.faces;
  const std::vector<std::uint32_t> at = firstAtPosition(faces.vertices);
  std::vector<Side> sides;
  for (std::size_t f = 0; f + 1 < all.firstFace.size(); ++f) {
    for (std::size_t t = all.firstFace[f]; t < all.firstFace[f + 1]; ++t) {
      const glm::uvec3& c = faces.triangles[t];
      sides.push_back({keyOf(at[c.x], at[c.y], at[c.z]), static_cast<std::uint16_t>(f + 1)});
    }
  }
  std::sort(sides.begin(), sides.end());
  LabelReader reader(*labels.blocks, labels);
  const FragmentsAt fragments(all, at);
  const std::vector<std::uint32_t>& material = faces.attributes.material;
  faces.neighbor.assign(faces.triangles.size(), 0);
  bool isAnyShared = false;
  for (std::size_t f = 0; f + 1 < all.firstFace.size(); ++f) {
    const auto own = static_cast<std::uint16_t>(f + 1);
    for (std::size_t t = all.firstFace[f]; t < all.firstFace[f + 1]; ++t) {
      const glm::uvec3& c = faces.triangles[t];
      const Side wanted{keyOf(at[c.x], at[c.z], at[c.y]), 0};
      const auto other = std::lower_bound(sides.begin(), sides.end(), wanted);
      if (other != sides.end() && other->key == wanted.key && other->fragment != own) {
        faces.neighbor[t] = other->fragment;
        isAnyShared = true;
      } else if (material.empty() || material[t] == JoinedMaterials::kInside) {
        faces.neighbor[t] = behind(faces, t, own, frame, reader);
        // Of a crack that was broken again on the other side only, and that no voxel reaches.
        if (faces.neighbor[t] == 0 && !material.empty()) faces.neighbor[t] = fragments.most(c, own);
      }
    }
  }
  return isAnyShared || all.firstFace.size() == 2;
}

std::string meshWithNeighbors(const std::vector<std::string>& meshes) {
  for (const std::string& name : meshes) {
    if (name.ends_with(".ply")) return name;
  }
  return meshes.empty() ? "" : meshes.front();
}

TriangleMesh originalOf(const TriangleMesh& faces) {
  TriangleMesh original;
  original.vertices = faces.vertices;
  for (std::size_t t = 0; t < faces.triangles.size(); ++t) {
    if (faces.neighbor[t] == 0) original.triangles.push_back(faces.triangles[t]);
  }
  return original;
}

SourceMesh originalSurface(const FragmentMeshes& all, SourceMesh source,
                           std::vector<std::uint32_t>& sourceOf) {
  std::vector<std::uint32_t> original;
  sourceOf.assign(all.faces.triangles.size(), TriangleMesh::kNoSource);
  for (std::uint32_t t = 0; t < all.faces.triangles.size(); ++t) {
    if (all.faces.neighbor[t] != 0) continue;
    sourceOf[t] = static_cast<std::uint32_t>(original.size());
    original.push_back(t);
  }
  TriangleMesh& mesh = source.mesh;
  mesh.vertices = all.faces.vertices;
  mesh.triangles = chosen(all.faces.triangles, original);
  const SurfaceAttributes& from = all.faces.attributes;
  mesh.attributes = {chosen(from.texcoords, original), chosen(from.colors, original),
                     chosen(from.material, original), chosen(from.normals, original)};
  source.polygons = chosen(all.polygons, original);
  source.appearance = all.appearance;
  const std::size_t materials = source.appearance.materials.size();
  if (materials == 0) mesh.attributes.material.clear();
  for (std::uint32_t& material : mesh.attributes.material) {  // of faces that close holes
    material = std::min(material, static_cast<std::uint32_t>(materials));
  }
  return source;
}

}  // namespace sherd
