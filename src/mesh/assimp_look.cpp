// What Assimp tells of the look of a glTF file.
#include "mesh/assimp_look.h"

#include <assimp/material.h>
#include <assimp/texture.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "mesh/beside.h"
#include "mesh/gltf_buffer.h"

namespace sherd {
namespace {

// The picture that a material names: "*3" is the third in the file, all else a file beside it.
int textureOf(const MeshFile& file, const aiScene& scene, const aiString& path, Appearance& look) {
  const std::string name = path.C_Str();
  const aiTexture* inFile = scene.GetEmbeddedTexture(path.C_Str());
  if (inFile == nullptr) return textureBeside(file, percentDecoded(name), look);
  const auto known = std::find_if(look.textures.begin(), look.textures.end(),
                                  [&](const Texture& t) { return t.name == name; });
  if (known != look.textures.end()) return static_cast<int>(known - look.textures.begin());
  const bool isFile = inFile->mHeight == 0 && inFile->pcData != nullptr && inFile->mWidth > 0;
  if (!isFile) return -1;
  look.textures.push_back(
      {name, std::string(reinterpret_cast<const char*>(inFile->pcData), inFile->mWidth)});
  return static_cast<int>(look.textures.size()) - 1;
}

glm::vec3 baseColour(const aiMaterial& material) {
  aiColor4D colour(1.0f, 1.0f, 1.0f, 1.0f);
  if (material.Get(AI_MATKEY_BASE_COLOR, colour) != aiReturn_SUCCESS) return glm::vec3(1.0f);
  glm::vec3 result(colour.r, colour.g, colour.b);
  for (int i = 0; i < 3; ++i) {
    result[i] = std::isfinite(result[i]) ? std::clamp(result[i], 0.0f, 1.0f) : 1.0f;
  }
  return result;
}

}  // namespace

AssimpLook lookOf(const MeshFile& file, const aiScene& scene, Appearance& look) {
  AssimpLook out;
  std::vector<bool> used(scene.mNumMaterials, false);
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[i];
    out.texcoords |= mesh.GetNumUVChannels() > 0;
    out.colours |= mesh.HasVertexColors(0);
    if (mesh.mMaterialIndex < used.size()) used[mesh.mMaterialIndex] = true;
  }
  bool told = false;
  std::vector<std::uint32_t> numbers(scene.mNumMaterials, 0);
  out.texcoordSet.assign(scene.mNumMaterials, 0);
  Appearance found;
  for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
    if (!used[i]) continue;
    const aiMaterial& source = *scene.mMaterials[i];
    Material material;
    aiString text;
    if (source.Get(AI_MATKEY_NAME, text) == aiReturn_SUCCESS) material.name = text.C_Str();
    // What Assimp calls the material that a file does not name.
    if (material.name == AI_DEFAULT_MATERIAL_NAME) material.name.clear();
    material.colour = baseColour(source);
    if (out.texcoords &&
        source.Get(AI_MATKEY_TEXTURE(aiTextureType_BASE_COLOR, 0), text) == aiReturn_SUCCESS) {
      material.texture = textureOf(file, scene, text, found);
      int set = 0;
      source.Get(AI_MATKEY_UVWSRC(aiTextureType_BASE_COLOR, 0), set);
      out.texcoordSet[i] =
          static_cast<unsigned>(std::clamp(set, 0, AI_MAX_NUMBER_OF_TEXTURECOORDS - 1));
    }
    told |= !material.name.empty() || material.texture >= 0 || material.colour != glm::vec3(1.0f);
    numbers[i] = static_cast<std::uint32_t>(found.materials.size());
    found.materials.push_back(std::move(material));
  }
  if (told) {
    out.material = std::move(numbers);
  } else {
    found.materials.clear();
  }
  // Pictures in the file are "*0" and so on; a name makes them files.
  for (Texture& texture : found.textures) {
    if (texture.name.starts_with('*')) texture.name = "texture_" + texture.name.substr(1);
  }
  look = std::move(found);
  return out;
}

void appendLook(const aiMesh& mesh, const AssimpLook& look, RawMesh& out) {
  if (look.texcoords) {
    unsigned set =
        mesh.mMaterialIndex < look.texcoordSet.size() ? look.texcoordSet[mesh.mMaterialIndex] : 0;
    if (!mesh.HasTextureCoords(set)) set = 0;
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      glm::vec2 at(0.0f);
      if (mesh.HasTextureCoords(set)) {
        at = {mesh.mTextureCoords[set][i].x, mesh.mTextureCoords[set][i].y};
      }
      const bool finite = std::isfinite(at.x) && std::isfinite(at.y);
      out.texcoords.push_back(finite ? at : glm::vec2(0.0f));
    }
  }
  if (look.colours) {
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      glm::vec3 colour(1.0f);
      if (mesh.HasVertexColors(0)) {
        colour = {mesh.mColors[0][i].r, mesh.mColors[0][i].g, mesh.mColors[0][i].b};
      }
      out.colours.push_back(srgbFromLinear(colour));
    }
  }
  if (!look.material.empty()) {
    out.material.resize(out.triangles.size(), mesh.mMaterialIndex < look.material.size()
                                                  ? look.material[mesh.mMaterialIndex]
                                                  : 0);
  }
}

}  // namespace sherd
