// Material libraries of OBJ files.
//
// Read here because Assimp 5.2.5 reads beyond the end of some malformed ones.
#include "formats/obj/mtl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <utility>

#include "base/text/text_scan.h"
#include "formats/mesh/material.h"

namespace sherd {
namespace {

// A map's file and its tiling.
struct Map {
  std::string_view name;
  MtlTiling tiling{};
};

// Reads one to three numbers, of which the first two are used: "-s 2" is for the first direction
// alone.
glm::vec2 pairOf(std::string_view& rest, glm::vec2 usual) {
  for (int i = 0; i < 3; ++i) {
    std::string_view next = rest;
    const auto value = parseReal(takeWord(next));
    if (!value) break;
    const auto number = static_cast<float>(*value);
    if (i < 2 && std::isfinite(number)) usual[i] = number;
    rest = next;
  }
  return usual;
}

// Returns what follows the options of a map: "-s 2 2 1 -clamp on the bark.png".
Map mapOf(std::string_view line) {
  constexpr std::array<std::pair<std::string_view, int>, 11> kWords{{{"-blendu", 1},
                                                                     {"-blendv", 1},
                                                                     {"-boost", 1},
                                                                     {"-bm", 1},
                                                                     {"-cc", 1},
                                                                     {"-clamp", 1},
                                                                     {"-imfchan", 1},
                                                                     {"-mm", 2},
                                                                     {"-texres", 1},
                                                                     {"-type", 1},
                                                                     {"-colorspace", 1}}};
  MtlTiling tiling;
  for (;;) {
    std::string_view rest = line;
    const std::string_view word = takeWord(rest);
    if (word == "-o") {
      tiling.offset = pairOf(rest, tiling.offset);
    } else if (word == "-s") {
      tiling.scale = pairOf(rest, tiling.scale);
    } else if (word == "-t") {  // turbulence, which no other format has
      pairOf(rest, {});
    } else {
      const auto* known = std::find_if(kWords.begin(), kWords.end(),
                                       [&](const auto& option) { return option.first == word; });
      if (known == kWords.end()) return {trimmed(line), tiling};
      for (int i = 0; i < known->second; ++i) takeWord(rest);
    }
    line = rest;
  }
}

// Returns the first numbers of a line; nothing if one is not a number.
std::optional<glm::vec3> colorOf(std::string_view rest) {
  glm::vec3 color(0.0f);
  for (int i = 0; i < 3; ++i) {
    const auto value = parseReal(takeWord(rest));
    if (!value || !std::isfinite(static_cast<float>(*value))) return std::nullopt;
    color[i] = std::max(static_cast<float>(*value), 0.0f);
  }
  return color;
}

std::optional<double> shareOf(std::string_view rest) {
  std::string_view after = rest;
  if (takeWord(after) == "-halo") rest = after;
  const auto value = parseReal(takeWord(rest));
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return std::clamp(static_cast<double>(*value), 0.0, 1.0);
}

// Sets one of a material's maps.  The tiling of map_Kd is that of all.
void setMap(std::string* map, const Map& read, MtlMaterial& material) {
  const bool isBase = map == &material.texture;
  const bool isFirst = material.texture.empty() && material.roughnessMap.empty() &&
                       material.metallicMap.empty() && material.emissionMap.empty() &&
                       material.opacityMap.empty() && material.normalMap.empty() &&
                       material.bumpMap.empty();
  material.hasOtherTilings |= !isFirst && read.tiling != material.tiling;
  if (isBase || isFirst) material.tiling = read.tiling;
  *map = read.name;
}

void take(std::string_view keyword, std::string_view rest, MtlMaterial& material) {
  const std::array<std::pair<std::string_view, std::string*>, 10> maps{
      {{"map_Kd", &material.texture},
       {"map_Pr", &material.roughnessMap},
       {"map_Pm", &material.metallicMap},
       {"map_Ke", &material.emissionMap},
       {"map_d", &material.opacityMap},
       {"norm", &material.normalMap},
       {"map_Bump", &material.bumpMap},
       {"map_bump", &material.bumpMap},
       {"bump", &material.bumpMap},
       {"Bump", &material.bumpMap}}};
  for (const auto& [name, map] : maps) {
    if (keyword == name) setMap(map, mapOf(rest), material);
  }
  if (keyword == "Kd") {
    if (const auto color = colorOf(rest)) material.color = glm::min(*color, glm::vec3(1.0f));
  }
  if (keyword == "Ke") {
    if (const auto color = colorOf(rest)) material.emission = *color;
  }
  const std::array<std::pair<std::string_view, std::optional<double>*>, 3> shares{
      {{"Pr", &material.roughness}, {"Pm", &material.metallic}, {"d", &material.opacity}}};
  for (const auto& [name, value] : shares) {
    if (keyword != name) continue;
    if (const auto share = shareOf(rest)) *value = *share;
  }
}

}  // namespace

void addMtl(std::string_view text, std::map<std::string, MtlMaterial>& materials) {
  MtlMaterial ignored;
  MtlMaterial* material = nullptr;
  LineReader lines(text);
  while (lines.next()) {
    std::string_view rest = lines.line();
    const std::string_view keyword = takeWord(rest);
    if (keyword == "newmtl") {
      const auto [at, isNew] = materials.try_emplace(std::string(trimmed(rest)));
      material = isNew ? &at->second : &ignored;
    } else if (material != nullptr) {
      take(keyword, rest, *material);
    }
  }
}

std::string gltfOf(const MtlMaterial& material, int texture,
                   const std::function<int(const std::string&)>& textureOf,
                   const std::function<bool(int)>& isGray, std::vector<std::string>& leftOut) {
  PbrMaterial pbr;
  const auto map = [&](const std::string& name) { return name.empty() ? -1 : textureOf(name); };
  pbr.roughness = material.roughness.value_or(1.0);
  pbr.metallic = material.metallic.value_or(0.0);
  // One texture has both.  A gray one has roughness, with a metallic factor of 0 nothing else.
  const bool hasBoth = material.roughnessMap == material.metallicMap;
  if (hasBoth || (material.metallicMap.empty() && pbr.metallic == 0.0)) {
    pbr.roughnessTexture = map(material.roughnessMap);
    if (pbr.roughnessTexture >= 0 && pbr.roughness == 0.0) pbr.roughness = 1.0;
    if (pbr.roughnessTexture >= 0 && hasBoth && pbr.metallic == 0.0) pbr.metallic = 1.0;
  } else {
    for (const std::string& name : {material.roughnessMap, material.metallicMap}) {
      if (!name.empty()) leftOut.push_back(name);
    }
  }
  pbr.normalTexture = map(material.normalMap);
  if (material.normalMap.empty() && !material.bumpMap.empty()) {
    pbr.normalTexture = map(material.bumpMap);
    if (pbr.normalTexture >= 0 && isGray(pbr.normalTexture)) {
      leftOut.push_back(material.bumpMap);
      pbr.normalTexture = -1;
    }
  }
  pbr.emissionTexture = map(material.emissionMap);
  pbr.emission = material.emission.value_or(glm::vec3(0.0f));
  if (pbr.emissionTexture >= 0 && pbr.emission == glm::dvec3(0.0)) pbr.emission = glm::dvec3(1.0);
  pbr.opacity = material.opacity.value_or(1.0);
  const bool hasAlphaMap = texture >= 0 && material.opacityMap == material.texture;
  if (!hasAlphaMap && !material.opacityMap.empty()) leftOut.push_back(material.opacityMap);
  if (pbr.opacity < 1.0 || hasAlphaMap) pbr.alpha = PbrMaterial::Alpha::blend;
  const bool isPlain = pbr.roughness == 1.0 && pbr.metallic == 0.0 && pbr.roughnessTexture < 0 &&
                       pbr.normalTexture < 0 && pbr.emissionTexture < 0 &&
                       pbr.emission == glm::dvec3(0.0) && pbr.alpha == PbrMaterial::Alpha::opaque;
  return isPlain ? "" : gltfOf(pbr, material.color, texture);
}

}  // namespace sherd
