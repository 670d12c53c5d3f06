// The materials of a glTF file that is written.
#include "formats/gltf/glb_materials.h"

#include <limits>

#include "formats/gltf/gltf_texture_uses.h"

namespace sherd {

std::size_t GlbMaterials::numberOf(std::uint32_t material, const SurfaceAttributes& attributes) {
  int& number = numbers_[material];
  if (number < 0) {
    file_.materials.push_back(jsonOf(material, attributes));
    noteExtensions(file_.materials.back());
    number = static_cast<int>(file_.materials.size()) - 1;
  }
  return static_cast<std::size_t>(number);
}

// The input's object of glTF as it is, but for its name and its textures.
GlbMaterials::Json GlbMaterials::jsonOf(std::uint32_t material,
                                        const SurfaceAttributes& attributes) {
  const MaterialTable::Entry& entry = table_.materials[material];
  if (entry.gltf.empty()) return plainJson(material, attributes);
  Json own = Json::parse(entry.gltf.begin(), entry.gltf.end(), nullptr, /*allow_exceptions=*/false);
  if (!own.is_object()) return plainJson(material, attributes);
  forEachTextureUse(own,
                    [&](Json& use) { return !attributes.texcoords.empty() && placeTexture(use); });
  Json json = {{"name", entry.name}};
  own.erase("name");
  json.update(own);
  return json;
}

GlbMaterials::Json GlbMaterials::plainJson(std::uint32_t material,
                                           const SurfaceAttributes& attributes) {
  const MaterialTable::Entry& entry = table_.materials[material];
  glm::vec3 color = entry.color;
  // Vertex colors already contain that of the inside.
  if (material == table_.inside() && !attributes.colors.empty()) color = glm::vec3(1.0f);
  Json surface = {{"baseColorFactor", {color.x, color.y, color.z, 1.0}},
                  {"metallicFactor", 0.0},
                  {"roughnessFactor", 1.0}};
  Json use = {{"index", entry.texture}};
  if (!attributes.texcoords.empty() && entry.texture >= 0 && placeTexture(use)) {
    surface["baseColorTexture"] = std::move(use);
  }
  return {{"name", entry.name}, {"pbrMetallicRoughness", std::move(surface)}};
}

// Makes a use of an image of the table one of a texture of the file; false if it cannot be in it.
bool GlbMaterials::placeTexture(Json& use) {
  const Json& index = use["index"];
  if (!index.is_number_integer() || index < 0 || index >= table_.textures.size()) return false;
  const auto sampler = use.find("sampler");
  const int number = textureNumber(index.get<int>(), sampler == use.end() ? Json() : *sampler);
  if (number < 0) return false;
  use["index"] = number;
  use.erase("sampler");
  return true;
}

// Returns the number of a texture in the file, or -1: glTF supports only PNG and JPEG.
int GlbMaterials::textureNumber(int image, const Json& sampler) {
  const MaterialTable::Image& source = table_.textures[static_cast<std::size_t>(image)];
  if (source.type == ImageType::other) return -1;
  const std::string text = sampler.is_object() ? sampler.dump() : "";
  const auto [known, isNew] = textures_.try_emplace({image, text}, file_.textures.size());
  if (!isNew) return static_cast<int>(known->second);
  int& imageNumber = imageNumbers_[static_cast<std::size_t>(image)];
  if (imageNumber < 0) {
    file_.begin();
    file_.bytes += source.bytes;
    imageNumber = static_cast<int>(file_.images.size());
    file_.images.push_back(
        {{"name", source.file},
         {"mimeType", source.type == ImageType::png ? "image/png" : "image/jpeg"},
         {"bufferView", file_.end(kGltfNoTarget)}});
  }
  Json texture = {{"source", imageNumber}};
  if (!text.empty()) {
    const auto [at, isNewSampler] = samplers_.try_emplace(text, file_.samplers.size());
    if (isNewSampler) file_.samplers.push_back(sampler);
    texture["sampler"] = at->second;
  }
  file_.textures.push_back(std::move(texture));
  return static_cast<int>(known->second);
}

void GlbMaterials::noteExtensions(const Json& object) {
  for (const auto& [key, value] : object.items()) {
    if (!value.is_object() || key == "extras") continue;
    if (key == "extensions") {
      for (const auto& [name, extension] : value.items()) file_.extensionsUsed.insert(name);
    }
    noteExtensions(value);
  }
}

}  // namespace sherd
