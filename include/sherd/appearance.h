// Surface attributes of a mesh: texture coordinates, colors and materials.
#pragma once

#include <array>
#include <cstdint>
#include <glm/gtc/type_precision.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace sherd {

/// Face-varying attributes of a mesh of m triangles; each array may be empty.
struct SurfaceAttributes {
  std::vector<std::array<glm::vec2, 3>> texcoords;  ///< [m] u to the right, v upwards: (0, 0) is
                                                    ///< the image's lower left corner, as in OBJ
  std::vector<std::array<glm::u8vec3, 3>> colors;   ///< [m] sRGB
  std::vector<std::uint32_t> material;              ///< [m] index into Appearance::materials

  [[nodiscard]] bool empty() const {
    return texcoords.empty() && colors.empty() && material.empty();
  }
};

/// An image used by materials.
struct Texture {
  std::string name;   ///< from the mesh's file; generated where the file has none
  std::string bytes;  ///< the undecoded image file, not empty
};

struct Material {
  std::string name;       ///< may be empty, may repeat
  glm::vec3 color{1.0f};  ///< 0..1, linear; the texture is multiplied by it
  int texture = -1;       ///< index into Appearance::textures; -1: none
};

/// The materials and textures of a mesh that was read.  They have no influence on the fracture.
struct Appearance {
  std::vector<Material> materials;  ///< empty where the file has none
  std::vector<Texture> textures;
};

/// The color of fracture surfaces, sRGB.
inline constexpr glm::u8vec3 kInsideColor{224, 214, 196};

/// Detects the image format from a file's first bytes.
enum class ImageType { png, jpeg, other };
[[nodiscard]] ImageType imageType(std::string_view bytes);

/// The sRGB transfer function and its inverse, per channel; linear values are 0..1.
[[nodiscard]] glm::vec3 linearFromSrgb(glm::u8vec3 color);
[[nodiscard]] glm::u8vec3 srgbFromLinear(glm::vec3 color);  ///< clamps to 0..1

}  // namespace sherd
