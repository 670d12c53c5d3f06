// Materials of a glTF file.
#include "formats/mesh/gltf_attributes.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "base/text_scan.h"
#include "formats/mesh/beside.h"

namespace sherd {
namespace {

using Json = GltfDocument::Json;

const Json& baseColorTexture(const Json& material) {
  const Json& pbr = GltfDocument::member(material, "pbrMetallicRoughness");
  return GltfDocument::member(pbr, "baseColorTexture");
}

bool isEmbedded(const Json& image) {
  const auto uri = image.find("uri");
  return uri == image.end() || uri->get_ref<const std::string&>().starts_with("data:");
}

// Maps the images embedded in a file to textures of a mesh.
class EmbeddedImages {
 public:
  explicit EmbeddedImages(const GltfDocument& document) : document_(document) {}

  // Returns the index in `mesh` of the texture with that image, which is read once.
  int textureOf(std::size_t index, RawMesh& mesh) {
    const auto known = textures_.find(index);
    if (known != textures_.end()) return known->second;
    return textures_[index] = read(index, mesh);
  }

 private:
  int read(std::size_t index, RawMesh& mesh) {
    const Json& image = document_.array("images")[index];
    const std::string name = "texture_" + std::to_string(before(index));
    const auto uri = image.find("uri");
    std::string bytes;
    if (uri != image.end()) {
      const auto& text = uri->get_ref<const std::string&>();
      charge(document_.file(), text.size());
      bytes = dataUriBytes(text);
    } else {
      const std::string_view view =
          document_.bufferView(document_.number(image, "bufferView", 0xffffffff));
      charge(document_.file(), view.size());
      bytes = view;
    }
    if (bytes.empty()) return -1;
    mesh.appearance.textures.push_back({name, std::move(bytes)});
    return static_cast<int>(mesh.appearance.textures.size()) - 1;
  }

  // Returns the number of embedded images before that one.
  std::size_t before(std::size_t index) {
    const Json& images = document_.array("images");
    while (before_.size() <= index) {
      before_.push_back(before_.back() + (isEmbedded(images[before_.size() - 1]) ? 1 : 0));
    }
    return before_[index];
  }

  const GltfDocument& document_;
  std::map<std::size_t, int> textures_;  // by image
  std::vector<std::size_t> before_{0};
};

int textureOf(const GltfDocument& document, const Json& material, EmbeddedImages& images,
              RawMesh& mesh) {
  const Json& use = baseColorTexture(material);
  if (!use.contains("index")) return -1;
  const Json& texture = document.at("textures", document.number(use, "index"));
  if (!texture.contains("source")) {
    mesh.warnings.push_back(document.file().name +
                            ": a texture is of a kind that is not read, so it is left out");
    return -1;
  }
  const std::size_t source = document.number(texture, "source");
  const Json& image = document.at("images", source);
  if (isEmbedded(image)) return images.textureOf(source, mesh);
  return textureBeside(document.file(),
                       percentDecoded(image.at("uri").get_ref<const std::string&>()), mesh);
}

glm::vec3 baseColor(const Json& material) {
  const Json& pbr = GltfDocument::member(material, "pbrMetallicRoughness");
  const Json& factor = GltfDocument::member(pbr, "baseColorFactor");
  glm::vec3 color(1.0f);
  for (int i = 0; i < 3 && factor.is_array() && factor.size() >= 3; ++i) {
    color[i] = std::clamp(factor[static_cast<std::size_t>(i)].get<float>(), 0.0f, 1.0f);
  }
  return color;
}

}  // namespace

std::size_t texcoordSetOf(const GltfDocument& document, std::size_t material) {
  if (material >= document.array("materials").size()) return 0;
  return document.number(baseColorTexture(document.at("materials", material)), "texCoord");
}

std::vector<std::uint32_t> addMaterials(const GltfDocument& document, const std::vector<bool>& used,
                                        bool textured, RawMesh& out) {
  std::vector<std::uint32_t> numbers(used.size(), 0);
  std::vector<Material>& materials = out.appearance.materials;
  EmbeddedImages images(document);
  bool hasContent = false;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    Material material;
    if (i + 1 < used.size()) {
      const Json& source = document.at("materials", i);
      material.name = source.value("name", std::string());
      material.color = baseColor(source);
      if (textured) material.texture = textureOf(document, source, images, out);
    }
    hasContent |=
        !material.name.empty() || material.texture >= 0 || material.color != glm::vec3(1.0f);
    numbers[i] = static_cast<std::uint32_t>(materials.size());
    materials.push_back(std::move(material));
  }
  if (hasContent) return numbers;
  materials.clear();
  return {};
}

}  // namespace sherd
