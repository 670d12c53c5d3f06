// Materials of a glTF file.
#include "mesh/gltf_look.h"

#include <algorithm>
#include <string>
#include <utility>

#include "mesh/beside.h"
#include "mesh/text_scan.h"

namespace sherd {
namespace {

using Json = GltfDocument::Json;

const Json& baseColourTexture(const Json& material) {
  const Json& pbr = GltfDocument::member(material, "pbrMetallicRoughness");
  return GltfDocument::member(pbr, "baseColorTexture");
}

bool isInFile(const Json& image) {
  const auto uri = image.find("uri");
  return uri == image.end() || uri->get_ref<const std::string&>().starts_with("data:");
}

// The number of a picture in the file among `mesh`'s, read once.
int textureInFile(const GltfDocument& document, std::size_t index, RawMesh& mesh) {
  const Json& images = document.array("images");
  const auto before = std::count_if(images.begin(), images.begin() + static_cast<int>(index),
                                    [](const Json& image) { return isInFile(image); });
  const std::string name = "texture_" + std::to_string(before);
  std::vector<Texture>& textures = mesh.look.textures;
  const auto known = std::find_if(textures.begin(), textures.end(),
                                  [&](const Texture& t) { return t.name == name; });
  if (known != textures.end()) return static_cast<int>(known - textures.begin());
  const Json& image = images[index];
  const auto uri = image.find("uri");
  std::string bytes =
      uri != image.end()
          ? dataUriBytes(uri->get_ref<const std::string&>())
          : std::string(document.bufferView(document.number(image, "bufferView", 0xffffffff)));
  if (bytes.empty()) return -1;
  textures.push_back({name, std::move(bytes)});
  return static_cast<int>(textures.size()) - 1;
}

int textureOf(const GltfDocument& document, const Json& material, RawMesh& mesh) {
  const Json& use = baseColourTexture(material);
  if (!use.contains("index")) return -1;
  const Json& texture = document.at("textures", document.number(use, "index"));
  if (!texture.contains("source")) {
    mesh.warnings.push_back(document.file().name +
                            ": a texture is of a kind that is not read, so it is left out");
    return -1;
  }
  const std::size_t source = document.number(texture, "source");
  const Json& image = document.at("images", source);
  if (isInFile(image)) return textureInFile(document, source, mesh);
  return textureBeside(document.file(),
                       percentDecoded(image.at("uri").get_ref<const std::string&>()), mesh);
}

glm::vec3 baseColour(const Json& material) {
  const Json& pbr = GltfDocument::member(material, "pbrMetallicRoughness");
  const Json& factor = GltfDocument::member(pbr, "baseColorFactor");
  glm::vec3 colour(1.0f);
  for (int i = 0; i < 3 && factor.is_array() && factor.size() >= 3; ++i) {
    colour[i] = std::clamp(factor[static_cast<std::size_t>(i)].get<float>(), 0.0f, 1.0f);
  }
  return colour;
}

}  // namespace

std::size_t texcoordSetOf(const GltfDocument& document, std::size_t material) {
  if (material >= document.array("materials").size()) return 0;
  return document.number(baseColourTexture(document.at("materials", material)), "texCoord");
}

std::vector<std::uint32_t> addMaterials(const GltfDocument& document, const std::vector<bool>& used,
                                        bool textured, RawMesh& out) {
  std::vector<std::uint32_t> numbers(used.size(), 0);
  std::vector<Material>& materials = out.look.materials;
  bool told = false;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    Material material;
    if (i + 1 < used.size()) {
      const Json& source = document.at("materials", i);
      material.name = source.value("name", std::string());
      material.colour = baseColour(source);
      if (textured) material.texture = textureOf(document, source, out);
    }
    told |= !material.name.empty() || material.texture >= 0 || material.colour != glm::vec3(1.0f);
    numbers[i] = static_cast<std::uint32_t>(materials.size());
    materials.push_back(std::move(material));
  }
  if (told) return numbers;
  materials.clear();
  return {};
}

}  // namespace sherd
