// Materials as objects of glTF 2.0.
#include "formats/mesh/material.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <nlohmann/json.hpp>

namespace sherd {
namespace {

using Json = nlohmann::ordered_json;

const Json& member(const Json& object, const char* name) {
  static const Json kNone = Json::object();
  const auto found = object.find(name);
  return found != object.end() && found->is_object() ? *found : kNone;
}

double number(const Json& object, const char* name, double otherwise) {
  const auto found = object.find(name);
  return found != object.end() && found->is_number() ? found->get<double>() : otherwise;
}

double share(const Json& object, const char* name, double otherwise) {
  return std::clamp(number(object, name, otherwise), 0.0, 1.0);
}

int textureOf(const Json& object, const char* name) {
  const Json& use = member(object, name);
  const auto found = use.find("index");
  if (found == use.end() || !found->is_number_unsigned()) return -1;
  const auto index = found->get<std::uint64_t>();
  return index <= std::numeric_limits<int>::max() ? static_cast<int>(index) : -1;
}

glm::dvec3 emissionOf(const Json& material) {
  glm::dvec3 emission(0.0);
  const auto factor = material.find("emissiveFactor");
  if (factor != material.end() && factor->is_array() && factor->size() == 3) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Json& value = (*factor)[i];
      if (value.is_number()) emission[static_cast<int>(i)] = value.get<double>();
    }
  }
  const Json& strength = member(member(material, "extensions"), "KHR_materials_emissive_strength");
  return std::max(0.0, number(strength, "emissiveStrength", 1.0)) *
         glm::clamp(emission, glm::dvec3(0.0), glm::dvec3(1.0));
}

Json rgb(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

void addEmission(Json& json, const PbrMaterial& material) {
  const double most = std::max({material.emission.x, material.emission.y, material.emission.z});
  if (most > 0.0) json["emissiveFactor"] = rgb(material.emission / std::max(1.0, most));
  if (material.emissionTexture >= 0) {
    json["emissiveTexture"] = {{"index", material.emissionTexture}};
  }
  if (most > 1.0) {
    json["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", most}};
  }
}

}  // namespace

PbrMaterial pbrOf(const std::string& gltf) {
  PbrMaterial out;
  const Json json = Json::parse(gltf.begin(), gltf.end(), nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return out;
  const Json& pbr = member(json, "pbrMetallicRoughness");
  out.roughness = share(pbr, "roughnessFactor", 1.0);
  out.metallic = share(pbr, "metallicFactor", 1.0);
  out.roughnessTexture = textureOf(pbr, "metallicRoughnessTexture");
  const auto color = pbr.find("baseColorFactor");
  if (color != pbr.end() && color->is_array() && color->size() == 4 && (*color)[3].is_number()) {
    out.opacity = std::clamp((*color)[3].get<double>(), 0.0, 1.0);
  }
  const auto mode = json.find("alphaMode");
  if (mode != json.end() && *mode == "MASK") out.alpha = PbrMaterial::Alpha::mask;
  if (mode != json.end() && *mode == "BLEND") out.alpha = PbrMaterial::Alpha::blend;
  out.alphaCutoff = share(json, "alphaCutoff", 0.5);
  out.normalTexture = textureOf(json, "normalTexture");
  out.normalScale = number(member(json, "normalTexture"), "scale", 1.0);
  out.occlusionTexture = textureOf(json, "occlusionTexture");
  out.emissionTexture = textureOf(json, "emissiveTexture");
  out.emission = emissionOf(json);
  return out;
}

std::string gltfOf(const PbrMaterial& material, const glm::vec3& color, int baseColorTexture) {
  Json pbr = {{"baseColorFactor", {color.x, color.y, color.z, material.opacity}}};
  if (baseColorTexture >= 0) pbr["baseColorTexture"] = {{"index", baseColorTexture}};
  pbr["metallicFactor"] = material.metallic;
  pbr["roughnessFactor"] = material.roughness;
  if (material.roughnessTexture >= 0) {
    pbr["metallicRoughnessTexture"] = {{"index", material.roughnessTexture}};
  }
  Json json = {{"pbrMetallicRoughness", std::move(pbr)}};
  if (material.normalTexture >= 0) {
    json["normalTexture"] = {{"index", material.normalTexture}};
    if (material.normalScale != 1.0) json["normalTexture"]["scale"] = material.normalScale;
  }
  if (material.occlusionTexture >= 0) {
    json["occlusionTexture"] = {{"index", material.occlusionTexture}};
  }
  addEmission(json, material);
  if (material.alpha == PbrMaterial::Alpha::blend) json["alphaMode"] = "BLEND";
  if (material.alpha == PbrMaterial::Alpha::mask) {
    json["alphaMode"] = "MASK";
    json["alphaCutoff"] = material.alphaCutoff;
  }
  return json.dump();
}

}  // namespace sherd
