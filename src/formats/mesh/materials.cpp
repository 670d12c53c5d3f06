// The materials that a fracture's mesh files name.
#include "formats/mesh/materials.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string_view>

#include "base/number_text.h"
#include "base/safe_name.h"

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
    table.materials.push_back({uniqueName(name, "", names), material.color, material.texture});
  }
  if (table.materials.empty()) table.materials.push_back({"outside"});
  table.materials.push_back({"inside", glm::vec3(kInsideColor) / 255.0f});

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

std::string mtlText(const MaterialTable& table) {
  std::string text = "# the materials of the pieces beside this file\n";
  for (const MaterialTable::Entry& material : table.materials) {
    text += "\nnewmtl " + material.name + "\nKd";
    for (int i = 0; i < 3; ++i) appendFloat(text += ' ', material.color[i]);
    text += "\nillum 1\n";
    if (material.texture < 0) continue;
    text += "map_Kd " + table.textures[static_cast<std::size_t>(material.texture)].file + "\n";
  }
  return text;
}

}  // namespace sherd
