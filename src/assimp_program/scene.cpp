// Reads a mesh by Assimp.
#include "assimp_program/scene.h"

#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/metadata.h>
#include <assimp/scene.h>
#include <assimp/texture.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/mesh/normals.h"
#include "formats/mesh/polygon_mesh.h"
#include "mesh/attributes/colors.h"

namespace sherd {
namespace {

Error refused(const std::string& why) { return Error(ErrorCode::input, why); }

// Gives Assimp the file in memory and no access to the disk.
class OneFile : public Assimp::IOSystem {
 public:
  OneFile(const std::string& bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}
  bool Exists(const char* name) const override { return name == name_; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (name != name_ || std::strchr(mode, 'w') != nullptr) return nullptr;
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes_.data()),
                                      bytes_.size());
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  const std::string& bytes_;
  std::string name_;
};

// world = linear * local + offset.
struct Affine {
  glm::dmat3 linear{1.0};
  glm::dvec3 offset{0.0};
};

Affine compose(const Affine& outer, const aiMatrix4x4& m) {
  const glm::dmat3 linear(m.a1, m.b1, m.c1, m.a2, m.b2, m.c2, m.a3, m.b3,
                          m.c3);  // column by column
  return {outer.linear * linear, outer.linear * glm::dvec3(m.a4, m.b4, m.c4) + outer.offset};
}

// The texture of a material: its base color in new formats, its diffuse color in old ones.
struct TextureUse {
  std::string path;  // empty: none
  unsigned set = 0;  // of texture coordinates
};

TextureUse textureOf(const aiMaterial& material) {
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    aiString path;
    if (material.Get(AI_MATKEY_TEXTURE(type, 0), path) != aiReturn_SUCCESS) continue;
    int set = 0;
    material.Get(AI_MATKEY_UVWSRC(type, 0), set);
    return {path.C_Str(),
            static_cast<unsigned>(std::clamp(set, 0, AI_MAX_NUMBER_OF_TEXTURECOORDS - 1))};
  }
  return {};
}

glm::vec3 colorOf(const aiMaterial& material) {
  aiColor4D color(1.0f, 1.0f, 1.0f, 1.0f);
  if (material.Get(AI_MATKEY_BASE_COLOR, color) != aiReturn_SUCCESS &&
      material.Get(AI_MATKEY_COLOR_DIFFUSE, color) != aiReturn_SUCCESS)
    return glm::vec3(1.0f);
  glm::vec3 out(color.r, color.g, color.b);
  for (int i = 0; i < 3; ++i)
    out[i] = std::isfinite(out[i]) ? std::clamp(out[i], 0.0f, 1.0f) : 1.0f;
  return out;
}

std::string withoutForeignFolders(const std::string& path) {
  const bool absolute =
      path.starts_with('/') || path.starts_with('\\') || (path.size() > 1 && path[1] == ':');
  return absolute ? path.substr(path.find_last_of("/\\:") + 1) : path;
}

int addTexture(const aiScene& scene, const std::string& path, std::vector<Texture>& textures) {
  Texture texture{withoutForeignFolders(path), {}};
  const auto [inFile, index] = scene.GetEmbeddedTextureAndIndex(path.c_str());
  if (inFile != nullptr) {
    const bool isFile = inFile->mHeight == 0 && inFile->pcData != nullptr && inFile->mWidth > 0;
    if (!isFile) return -1;
    texture = {"texture_" + std::to_string(index),
               std::string(reinterpret_cast<const char*>(inFile->pcData), inFile->mWidth)};
  }
  if (texture.name.empty()) return -1;
  const auto known = std::find_if(textures.begin(), textures.end(),
                                  [&](const Texture& t) { return t.name == texture.name; });
  if (known != textures.end()) return static_cast<int>(known - textures.begin());
  textures.push_back(std::move(texture));
  return static_cast<int>(textures.size()) - 1;
}

struct Reader {
  const aiScene& scene;
  PolygonMesh mesh{};
  RawMesh out{};
  bool hasTexcoords = false, hasColors = false, hasNormals = false, skinned = false,
       morphed = false;
  std::vector<glm::vec3> colors{};  // [mesh.vertices]

  void addMaterials() {
    bool hasContent = false;
    for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
      const aiMaterial& source = *scene.mMaterials[i];
      Material material;
      aiString name;
      if (source.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) material.name = name.C_Str();
      // Assimp's name for a material that has none in the file.
      if (material.name == AI_DEFAULT_MATERIAL_NAME) material.name.clear();
      material.color = colorOf(source);
      const TextureUse use = textureOf(source);
      if (hasTexcoords && !use.path.empty())
        material.texture = addTexture(scene, use.path, out.appearance.textures);
      hasContent |=
          !material.name.empty() || material.texture >= 0 || material.color != glm::vec3(1.0f);
      out.appearance.materials.push_back(std::move(material));
    }
    if (!hasContent) out.appearance.materials.clear();
  }

  // Colors default to white, texture coordinates and normals to 0 if only other meshes have them.
  void addVertices(const aiMesh& source, const Affine& world) {
    const bool known = source.mMaterialIndex < scene.mNumMaterials;
    unsigned set = known ? textureOf(*scene.mMaterials[source.mMaterialIndex]).set : 0;
    if (!source.HasTextureCoords(set)) set = 0;
    const glm::dmat3 ofNormals = normalTransform(world.linear);
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const aiVector3D& v = source.mVertices[i];
      mesh.vertices.push_back(world.linear * glm::dvec3(v.x, v.y, v.z) + world.offset);
      if (hasTexcoords) {
        const aiVector3D* at = source.mTextureCoords[set];
        mesh.vertexTexcoords.push_back(at == nullptr ? glm::vec2(0.0f)
                                                     : glm::vec2(at[i].x, at[i].y));
      }
      if (hasNormals) {
        const aiVector3D n = source.HasNormals() ? source.mNormals[i] : aiVector3D(0.0f);
        mesh.vertexNormals.push_back(transformedNormal(ofNormals, glm::vec3(n.x, n.y, n.z)));
      }
      if (hasColors) {
        const aiColor4D* color = source.mColors[0];
        colors.push_back(color == nullptr ? glm::vec3(1.0f)
                                          : glm::vec3(color[i].r, color[i].g, color[i].b));
      }
    }
  }

  void addMesh(const aiMesh& source, const Affine& world) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    addVertices(source, world);
    const bool mirrored = glm::determinant(world.linear) < 0.0;
    for (unsigned i = 0; i < source.mNumFaces; ++i) {
      const aiFace& face = source.mFaces[i];
      if (face.mNumIndices < 3) continue;  // points and lines
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        const unsigned corner = face.mIndices[mirrored ? face.mNumIndices - 1 - k : k];
        if (corner >= source.mNumVertices) {
          throw refused("face uses vertex " + std::to_string(corner) + ", its mesh has " +
                        std::to_string(source.mNumVertices));
        }
        mesh.corners.push_back(first + corner);
      }
      mesh.faceEnds.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    }
    mesh.objectOfFace.resize(mesh.faceEnds.size(),
                             static_cast<std::uint32_t>(out.objects.size()) - 1);
    if (!out.appearance.materials.empty()) {
      const auto last = static_cast<std::uint32_t>(out.appearance.materials.size()) - 1;
      mesh.faceMaterials.resize(mesh.faceEnds.size(), std::min(source.mMaterialIndex, last));
    }
    skinned |= source.HasBones();
    morphed |= source.mNumAnimMeshes > 0;
  }

  void addNodes() {
    struct Visit {
      const aiNode* node;
      Affine parent;
    };
    std::vector<Visit> stack{{scene.mRootNode, {}}};
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const Affine world = compose(visit.parent, visit.node->mTransformation);
      if (visit.node->mNumMeshes > 0) out.objects.emplace_back(visit.node->mName.C_Str());
      for (unsigned i = 0; i < visit.node->mNumMeshes; ++i)
        addMesh(*scene.mMeshes[visit.node->mMeshes[i]], world);
      for (unsigned i = visit.node->mNumChildren; i-- > 0;)
        stack.push_back({visit.node->mChildren[i], world});
    }
  }

  RawMesh read() {
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
      hasTexcoords |= scene.mMeshes[i]->GetNumUVChannels() > 0;
      hasNormals |= scene.mMeshes[i]->HasNormals();
      hasColors |= scene.mMeshes[i]->HasVertexColors(0);
    }
    addMaterials();
    addNodes();
    mesh.vertexColors = colorsFrom(colors);
    triangulateInto({}, std::move(mesh), out);
    if (skinned)
      out.warnings.emplace_back(
          "its skins are left out: the mesh is read as it is without its skeleton");
    if (morphed)
      out.warnings.emplace_back(
          "its morph targets are left out: the mesh is read as it is without them");
    return std::move(out);
  }
};

// What an FBX says of itself: its unit in centimeters, and its axis 0, 1 or 2.
void addCoordinates(const aiScene& scene, RawMesh& mesh) {
  constexpr double kMetersPerCentimeter = 0.01;
  if (scene.mMetaData == nullptr) return;
  double centimeters = 0.0;
  float single = 0.0f;
  if (!scene.mMetaData->Get("UnitScaleFactor", centimeters) &&
      scene.mMetaData->Get("UnitScaleFactor", single)) {
    centimeters = double{single};
  }
  if (std::isfinite(centimeters) && centimeters > 0.0) {
    mesh.metersPerUnit = centimeters * kMetersPerCentimeter;
  }
  std::int32_t axis = -1;
  if (scene.mMetaData->Get("UpAxis", axis) && axis >= 0 && axis <= 2) {
    mesh.up = static_cast<char>('x' + axis);
  }
}

}  // namespace

RawMesh readScene(const std::string& bytes, const std::string& extension) {
  Assimp::Importer importer;
  const std::string name = "mesh." + extension;
  importer.SetIOHandler(new OneFile(bytes, name));  // the importer deletes it
  // The file's axes stay as they are, as with all other formats.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  // No post-processing: Sherd merges and triangulates; Assimp's own steps are slow or leave holes.
  const aiScene* scene = importer.ReadFile(name, 0);
  if (scene == nullptr || scene->mRootNode == nullptr) throw refused(importer.GetErrorString());
  RawMesh mesh = Reader{.scene = *scene}.read();
  if (extension == "fbx") addCoordinates(*scene, mesh);
  return mesh;
}

}  // namespace sherd
