// Transforms of textures in glTF materials.
#include "formats/gltf/gltf_transforms.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "base/finite.h"
#include "base/text/text_scan.h"
#include "formats/gltf/gltf_texture_uses.h"

namespace sherd {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr const char* kTransform = "KHR_texture_transform";

// offset + rotation * scale * (u, v), in glTF's coordinates, whose v points down.
struct Transform {
  glm::vec2 offset{0.0f}, scale{1.0f};
  float rotation = 0.0f;  // radians
  bool operator==(const Transform&) const = default;

  [[nodiscard]] glm::vec2 of(glm::vec2 at) const {
    const float c = std::cos(rotation), s = std::sin(rotation);
    const glm::vec2 scaled = scale * at;
    return offset + glm::vec2(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x);
  }
};

glm::vec2 pairIn(const OrderedJson& transform, const char* key, glm::vec2 usual) {
  const auto found = transform.find(key);
  if (found == transform.end() || !found->is_array() || found->size() != 2) return usual;
  for (int i = 0; i < 2; ++i) {
    const OrderedJson& number = (*found)[static_cast<std::size_t>(i)];
    if (!number.is_number() || !std::isfinite(number.get<float>())) return usual;
    usual[i] = number.get<float>();
  }
  return usual;
}

// Returns the transform of a texture's use; that which changes nothing where it has none.
Transform transformOf(const OrderedJson& use) {
  const auto extensions = use.find("extensions");
  if (extensions == use.end() || !extensions->is_object()) return {};
  const auto found = extensions->find(kTransform);
  if (found == extensions->end() || !found->is_object()) return {};
  Transform transform{pairIn(*found, "offset", glm::vec2(0.0f)),
                      pairIn(*found, "scale", glm::vec2(1.0f))};
  const auto rotation = found->find("rotation");
  if (rotation != found->end() && rotation->is_number()) {
    transform.rotation = rotation->get<float>();
    if (!std::isfinite(transform.rotation)) transform.rotation = 0.0f;
  }
  return transform;
}

void removeTransform(OrderedJson& use) {
  const auto extensions = use.find("extensions");
  if (extensions == use.end() || !extensions->is_object()) return;
  extensions->erase(kTransform);
  if (extensions->empty()) use.erase("extensions");
}

}  // namespace

void applyTextureTransforms(const MeshFile& file, RawMesh& mesh) {
  std::vector<std::optional<Transform>> ofMaterial(mesh.appearance.materials.size());
  bool isAny = false;
  for (std::size_t m = 0; m < ofMaterial.size(); ++m) {
    Material& material = mesh.appearance.materials[m];
    if (material.gltf.find(kTransform) == std::string::npos) continue;
    OrderedJson json = OrderedJson::parse(material.gltf);
    std::optional<Transform> common;
    bool differ = false;
    forEachTextureUse(json, [&](OrderedJson& use) {
      const Transform own = transformOf(use);
      differ |= common && *common != own;
      if (!common) common = own;
      return true;
    });
    if (!common) continue;
    if (differ) {
      mesh.warnings.push_back(file.name + ": the textures of its material " +
                              inQuotes(material.name) +
                              " are transformed in several ways, which only glTF shows");
      continue;
    }
    forEachTextureUse(json, [&](OrderedJson& use) {
      removeTransform(use);
      return true;
    });
    material.gltf = json.dump();
    ofMaterial[m] = common;
    isAny = true;
  }
  SurfaceAttributes& attributes = mesh.attributes;
  if (!isAny || attributes.material.size() != attributes.texcoords.size()) return;
  for (std::size_t t = 0; t < attributes.texcoords.size(); ++t) {
    const std::optional<Transform>& own = ofMaterial[attributes.material[t]];
    if (!own) continue;
    for (glm::vec2& at : attributes.texcoords[t]) {
      const glm::vec2 moved = own->of({at.x, 1.0f - at.y});
      at = {moved.x, 1.0f - moved.y};
      if (!isFinite(at)) at = glm::vec2(0.0f);  // as in files
    }
  }
}

}  // namespace sherd
