// Material libraries of OBJ files.
#pragma once

#include <sherd/mesh.h>

#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// How a map lies on a surface: it shows offset + scale * texture coordinates.
struct MtlTiling {
  glm::vec2 scale{1.0f}, offset{0.0f};
  bool operator==(const MtlTiling&) const = default;
};

/// The properties of a material in a library.  Maps are files' names, without options; empty: none.
struct MtlMaterial {
  glm::vec3 color{1.0f};                               ///< Kd
  std::string texture;                                 ///< map_Kd
  std::optional<double> roughness, metallic, opacity;  ///< Pr, Pm, d
  std::optional<glm::vec3> emission;                   ///< Ke
  std::string roughnessMap, metallicMap;               ///< map_Pr, map_Pm
  std::string emissionMap, opacityMap;                 ///< map_Ke, map_d
  std::string normalMap;                               ///< norm
  MtlTiling tiling;                                    ///< of map_Kd, else of the first map
  bool hasOtherTilings = false;                        ///< of some other map
  std::string bumpMap;  ///< map_Bump or bump: a normal map, as Blender writes it, or heights
};

/// Adds the materials of a library's text by name; of two with one name the first counts. Malformed
/// lines are skipped.
void addMtl(std::string_view text, std::map<std::string, MtlMaterial>& materials);

/// Returns Material::gltf for a material of a library; empty if it has only a color and a texture.
///   texture    of the base color: an index into Appearance::textures, or -1
///   textureOf  returns the index of the image with that name, -1 if it cannot be read
///   isGray     returns whether an image has one channel
///   leftOut    receives the names of maps that a glTF material cannot have
[[nodiscard]] std::string gltfOf(const MtlMaterial& material, int texture,
                                 const std::function<int(const std::string&)>& textureOf,
                                 const std::function<bool(int)>& isGray,
                                 std::vector<std::string>& leftOut);

}  // namespace sherd
