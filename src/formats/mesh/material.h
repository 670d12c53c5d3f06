// Materials as objects of glTF 2.0, see Material::gltf.
#pragma once

#include <glm/vec3.hpp>
#include <string>

namespace sherd {

/// What formats other than glTF can have of a material, besides base color and its texture.
struct PbrMaterial {
  enum class Alpha { opaque, mask, blend };

  double roughness = 1.0, metallic = 0.0;
  glm::dvec3 emission{0.0};  ///< linear, may exceed 1
  double opacity = 1.0;      ///< the base color texture's alpha is multiplied by it
  Alpha alpha = Alpha::opaque;
  double alphaCutoff = 0.5;  ///< for Alpha::mask
  double normalScale = 1.0;  ///< of the normal texture's x and y
  // Indices into Appearance::textures; -1: none.
  int roughnessTexture = -1;  ///< green: roughness, blue: metallic; multiplied by these
  int normalTexture = -1;     ///< in tangent space, y upwards
  int emissionTexture = -1;   ///< multiplied by `emission`
  int occlusionTexture = -1;  ///< red
};

/// Reads an object of glTF; values of an unexpected type are as if absent.
///   gltf  Material::gltf; empty: rough and not metallic
[[nodiscard]] PbrMaterial pbrOf(const std::string& gltf);

/// Returns an object of glTF with a base color, its texture, and the other properties.
///   baseColorTexture  an index into Appearance::textures; -1: none
[[nodiscard]] std::string gltfOf(const PbrMaterial& material, const glm::vec3& color,
                                 int baseColorTexture);

}  // namespace sherd
