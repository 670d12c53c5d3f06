// Materials of a glTF file.
#include "formats/gltf/gltf_attributes.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "base/text/text_scan.h"
#include "formats/gltf/gltf_texture_uses.h"
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

// Reads the textures of materials.
class Textures {
 public:
  Textures(const GltfDocument& document, RawMesh& mesh)
      : document_(document), images_(document), mesh_(mesh) {}

  // Returns the index in the mesh of the image of a use of a texture, which is read once; -1 if it
  // cannot be read.
  int imageOf(const Json& use) {
    const std::size_t index = document_.number(use, "index");
    const auto [known, isNew] = imageOf_.try_emplace(index, -1);
    if (isNew) known->second = read(document_.at("textures", index));
    return known->second;
  }

  // Makes a use refer to the mesh's image and coordinates.
  //   texcoordSet  which the mesh has
  //   return       false if it cannot
  bool resolve(Json& use, std::size_t texcoordSet) {
    if (!use["index"].is_number_unsigned()) return false;
    const std::size_t index = document_.number(use, "index");
    const int image = imageOf(use);
    if (image < 0) return false;
    if (setOf(document_, use) != texcoordSet) {
      if (!std::exchange(warnedOfSet_, true)) {
        mesh_.warnings.push_back(document_.file().name +
                                 ": a texture has other coordinates than the base color, so it is "
                                 "left out");
      }
      return false;
    }
    use["index"] = image;
    use.erase("texCoord");
    use.erase("sampler");
    const Json& transform =
        GltfDocument::member(GltfDocument::member(use, "extensions"), "KHR_texture_transform");
    if (transform.is_object() && !transform.empty())
      use["extensions"]["KHR_texture_transform"].erase("texCoord");
    const Json& texture = document_.at("textures", index);
    if (texture.contains("sampler")) {
      use["sampler"] = document_.at("samplers", document_.number(texture, "sampler"));
    }
    return true;
  }

  // Returns the set of texture coordinates that a use has.
  static std::size_t setOf(const GltfDocument& document, const Json& use) {
    const Json& transform =
        GltfDocument::member(GltfDocument::member(use, "extensions"), "KHR_texture_transform");
    return document.number(transform, "texCoord", document.number(use, "texCoord"));
  }

 private:
  int read(const Json& texture) {
    if (!texture.contains("source")) {
      mesh_.warnings.push_back(document_.file().name +
                               ": a texture is of a kind that is not read, so it is left out");
      return -1;
    }
    const std::size_t source = document_.number(texture, "source");
    const Json& image = document_.at("images", source);
    if (isEmbedded(image)) return images_.textureOf(source, mesh_);
    return textureBeside(document_.file(),
                         percentDecoded(image.at("uri").get_ref<const std::string&>()), mesh_);
  }

  const GltfDocument& document_;
  EmbeddedImages images_;
  std::map<std::size_t, int> imageOf_;  // by texture
  bool warnedOfSet_ = false;
  RawMesh& mesh_;
};

// Returns the material for Material::gltf.
std::string gltfOf(const GltfDocument& document, Json material, bool textured,
                   std::size_t texcoordSet, Textures& textures) {
  charge(document.file(), material.dump().size());
  material.erase("name");
  forEachTextureUse(material,
                    [&](Json& use) { return textured && textures.resolve(use, texcoordSet); });
  return material.dump();
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
  const Json& json = document.at("materials", material);
  const Json& pbr = GltfDocument::member(json, "pbrMetallicRoughness");
  for (const Json* use : {&GltfDocument::member(pbr, "baseColorTexture"),
                          &GltfDocument::member(json, "normalTexture"),
                          &GltfDocument::member(pbr, "metallicRoughnessTexture"),
                          &GltfDocument::member(json, "occlusionTexture"),
                          &GltfDocument::member(json, "emissiveTexture")}) {
    if (use->contains("index")) return Textures::setOf(document, *use);
  }
  return 0;
}

std::vector<std::uint32_t> addMaterials(const GltfDocument& document, const std::vector<bool>& used,
                                        bool textured, RawMesh& out) {
  std::vector<std::uint32_t> numbers(used.size(), 0);
  std::vector<Material>& materials = out.appearance.materials;
  Textures textures(document, out);
  bool hasContent = false;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    Material material;
    if (i + 1 < used.size()) {
      const Json& source = document.at("materials", i);
      material.name = source.value("name", std::string());
      material.color = baseColor(source);
      const Json& use = baseColorTexture(source);
      if (textured && use.contains("index")) material.texture = textures.imageOf(use);
      hasContent |= source.size() > (source.contains("name") ? 1u : 0u);
    }
    hasContent |= !material.name.empty();
    numbers[i] = static_cast<std::uint32_t>(materials.size());
    materials.push_back(std::move(material));
  }
  if (!hasContent) {
    materials.clear();
    return {};
  }
  for (std::size_t i = 0; i + 1 < used.size(); ++i) {  // normal maps and the like are read last
    if (!used[i]) continue;
    materials[numbers[i]].gltf = gltfOf(document, document.at("materials", i), textured,
                                        texcoordSetOf(document, i), textures);
  }
  return numbers;
}

}  // namespace sherd
