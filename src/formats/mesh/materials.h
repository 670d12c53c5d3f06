// The materials that a fracture's mesh files name.
#pragma once

#include <sherd/mesh.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace sherd {

/// The input's materials, with names that every format supports, and the material of the inside.
struct MaterialTable {
  struct Entry {
    std::string name;  ///< unique, UTF-8 without blanks
    glm::vec3 color{1.0f};
    int texture = -1;    ///< an index into textures; -1: none
    std::string gltf{};  ///< see Material::gltf
  };
  struct Image {
    std::string file;   ///< unique, without a folder
    std::string bytes;  ///< as read
    ImageType type = ImageType::other;
  };

  std::vector<Entry> materials;  ///< "inside" last; before it the input's, or one named "outside"
  std::vector<Image> textures;

  [[nodiscard]] std::uint32_t inside() const {
    return static_cast<std::uint32_t>(materials.size()) - 1;
  }

  /// Returns how many textures, from the first, contain those of all base colors.  Readers add
  /// these before normal maps and the like, which some formats cannot use.
  [[nodiscard]] std::size_t baseColorTextures() const {
    int last = -1;
    for (const Entry& entry : materials) last = std::max(last, entry.texture);
    return static_cast<std::size_t>(last + 1);
  }
};

[[nodiscard]] MaterialTable materialTable(const Appearance& appearance);

/// Returns names for the input's objects as groups of OBJ files: UTF-8 without blanks, as often
/// equal as in the input, none of them kInsideGroup.
///   return  empty if the input has only one object
[[nodiscard]] std::vector<std::string> groupNames(const SourceMesh& source);
inline constexpr const char* kInsideGroup = "inside";

/// Returns whether a file with this name, without a folder, may be one of MaterialTable::textures.
[[nodiscard]] bool isTextureName(const std::string& file);

/// Returns the table's materials as a library for OBJ files.
[[nodiscard]] std::string mtlText(const MaterialTable& table);

}  // namespace sherd
