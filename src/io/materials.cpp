// The materials that a fracture's mesh files name.
#include "io/materials.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <set>

#include "io/file_names.h"
#include "io/number_text.h"

namespace sherd {
namespace {

// A name that is not taken yet: "bark", "bark_2", ...
std::string uniqueName(const std::string& name, const std::string& ending,
                       std::set<std::string>& taken) {
  std::string unique = name + ending;
  for (int i = 2; !taken.insert(unique).second; ++i) {
    unique = name + "_" + std::to_string(i) + ending;
  }
  return unique;
}

// By what is in it; else as it was, if that is none of a file of ours.
std::string endingOf(const std::string& name, ImageType type) {
  if (type == ImageType::png) return ".png";
  if (type == ImageType::jpeg) return ".jpg";
  const std::string ending = std::filesystem::path(name).extension().string();
  constexpr std::array<const char*, 7> kOurs{".ply", ".obj", ".mtl", ".glb", ".stl", ".binm", "."};
  const bool plain = ending.size() > 1 && ending.size() <= 5 &&
                     std::all_of(ending.begin() + 1, ending.end(), [](unsigned char c) {
                       return std::isdigit(c) || std::islower(c);
                     });
  const bool ours = std::find(kOurs.begin(), kOurs.end(), ending) != kOurs.end();
  return plain && !ours ? ending : ".image";
}

}  // namespace

MaterialTable materialTable(const Appearance& appearance) {
  MaterialTable table;
  std::set<std::string> names{"inside"};
  for (const Material& material : appearance.materials) {
    const std::string name =
        material.name.empty() ? "outside" : withoutBlanks(safeName(material.name, "outside"));
    table.materials.push_back({uniqueName(name, "", names), material.colour, material.texture});
  }
  if (table.materials.empty()) table.materials.push_back({"outside"});
  table.materials.push_back({"inside", glm::vec3(kInsideColour) / 255.0f});

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

std::string mtlText(const MaterialTable& table) {
  std::string text = "# the materials of the pieces beside this file\n";
  for (const MaterialTable::Entry& material : table.materials) {
    text += "\nnewmtl " + material.name + "\nKd";
    for (int i = 0; i < 3; ++i) appendFloat(text += ' ', material.colour[i]);
    text += "\nillum 1\n";
    if (material.texture < 0) continue;
    text += "map_Kd " + table.textures[static_cast<std::size_t>(material.texture)].file + "\n";
  }
  return text;
}

}  // namespace sherd
