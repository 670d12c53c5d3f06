// The materials that a fracture's mesh files name.
#include "formats/mesh/materials.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string_view>

#include "base/text/number_text.h"
#include "base/text/safe_name.h"
#include "formats/mesh/material.h"

namespace sherd {
namespace {

// Returns a name that is not taken yet: "bark", "bark_2", ...
std::string uniqueName(const std::string& name, const std::string& ending,
                       std::set<std::string>& taken) {
  std::string unique = name + ending;
  for (int i = 2; !taken.insert(unique).second; ++i) {
    unique = name + "_" + std::to_string(i) + ending;
  }
  return unique;
}

// Extensions of images. No others are written, so that no other file is mistaken for a texture.
constexpr std::array<std::string_view, 29> kImageEndings{
    ".png",  ".jpg",  ".jpeg", ".image", ".tga", ".bmp", ".dds",  ".tif", ".tiff", ".gif",
    ".webp", ".avif", ".heic", ".jp2",   ".jxl", ".ktx", ".ktx2", ".psd", ".hdr",  ".exr",
    ".pcx",  ".ppm",  ".pgm",  ".pnm",   ".sgi", ".rgb", ".pic",  ".svg", ".xpm"};

bool isImageEnding(std::string_view ending) {
  return std::find(kImageEndings.begin(), kImageEndings.end(), ending) != kImageEndings.end();
}

// Returns the extension of the image's type; for other types the file's, if it is an image's.
std::string endingOf(const std::string& name, ImageType type) {
  if (type == ImageType::png) return ".png";
  if (type == ImageType::jpeg) return ".jpg";
  const std::string ending = std::filesystem::path(name).extension().string();
  return isImageEnding(ending) ? ending : ".image";
}

}  // namespace

MaterialTable materialTable(const Appearance& appearance) {
  MaterialTable table;
  std::set<std::string> names{"inside"};
  for (const Material& material : appearance.materials) {
    const std::string name =
        material.name.empty() ? "outside" : withoutBlanks(safeName(material.name, "outside"));
    table.materials.push_back(
        {uniqueName(name, "", names), material.color, material.texture, material.gltf});
  }
  if (table.materials.empty()) table.materials.push_back({"outside"});
  table.materials.push_back({"inside", linearFromSrgb(kInsideColor)});

  std::set<std::string> files;
  for (const Texture& texture : appearance.textures) {
    const ImageType type = imageType(texture.bytes);
    std::string path = texture.name;
    std::replace(path.begin(), path.end(), '\\', '/');
    const std::string stem =
        withoutBlanks(safeName(std::filesystem::path(path).stem().string(), "texture"));
    table.textures.push_back({uniqueName(stem, endingOf(path, type), files), texture.bytes, type});
  }
  return table;
}

std::vector<std::string> groupNames(const SourceMesh& source) {
  std::vector<std::string> groups;
  if (source.objects.size() < 2 || source.objectOfTriangle.empty()) return groups;
  for (const std::string& object : source.objects) {
    groups.push_back(withoutBlanks(safeName(object, "object")));
    if (groups.back() == kInsideGroup) groups.back() += "_2";
  }
  return groups;
}

bool isTextureName(const std::string& file) {
  return file.find('/') == std::string::npos && !file.starts_with('.') &&
         isImageEnding(std::filesystem::path(file).extension().string());
}

namespace {

// Appends what a material of glTF has besides its color, and its maps.
void appendMtl(std::string& text, const MaterialTable& table, const MaterialTable::Entry& entry) {
  const PbrMaterial pbr = entry.gltf.empty() ? PbrMaterial() : pbrOf(entry.gltf);
  const auto number = [&text](const char* keyword, double value) {
    appendFloat((text += keyword) += ' ', static_cast<float>(value));
    text += '\n';
  };
  const auto map = [&](const char* keyword, int texture) {
    if (texture < 0 || static_cast<std::size_t>(texture) >= table.textures.size()) return;
    text.append(keyword).append(" ").append(table.textures[static_cast<std::size_t>(texture)].file);
    text += '\n';
  };
  const bool isOpaque = pbr.alpha == PbrMaterial::Alpha::opaque;
  if (!entry.gltf.empty()) {
    number("Pr", pbr.roughness);
    number("Pm", pbr.metallic);
    if (pbr.emission != glm::dvec3(0.0)) {
      text += "Ke";
      for (int i = 0; i < 3; ++i) appendFloat(text += ' ', static_cast<float>(pbr.emission[i]));
      text += '\n';
    }
    if (!isOpaque) number("d", pbr.opacity);
  }
  text += "illum 1\n";
  map("map_Kd", entry.texture);
  if (!isOpaque) map("map_d", entry.texture);
  map("map_Pr -imfchan g", pbr.roughnessTexture);
  if (pbr.metallic > 0.0) map("map_Pm -imfchan b", pbr.roughnessTexture);
  map("norm", pbr.normalTexture);
  map("map_Ke", pbr.emissionTexture);
}

}  // namespace

std::string mtlText(const MaterialTable& table) {
  std::string text = "# the materials of the pieces beside this file\n";
  for (const MaterialTable::Entry& material : table.materials) {
    text += "\nnewmtl " + material.name + "\nKd";
    for (int i = 0; i < 3; ++i) appendFloat(text += ' ', material.color[i]);
    appendMtl(text += '\n', table, material);
  }
  return text;
}

}  // namespace sherd
