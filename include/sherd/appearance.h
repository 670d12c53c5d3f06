// How a mesh looks: texture coordinates, colours and materials of its triangles.
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

/// What the triangles of a mesh look like, corner by corner; each array may be empty.
struct SurfaceLook {
  std::vector<std::array<glm::vec2, 3>> texcoords;  ///< [m] u to the right, v upwards: (0, 0) is
                                                    ///< the picture's lower left corner, as in OBJ
  std::vector<std::array<glm::u8vec3, 3>> colours;  ///< [m] sRGB, as pictures have them
  std::vector<std::uint32_t> material;              ///< [m] an index into Appearance::materials

  [[nodiscard]] bool empty() const {
    return texcoords.empty() && colours.empty() && material.empty();
  }
};

/// A picture that a material is made of.
struct Texture {
  std::string name;   ///< as the mesh's file names it, or made up where it has none
  std::string bytes;  ///< the picture's file as it was read, not empty
};

struct Material {
  std::string name;        ///< may be empty, and need not be unique
  glm::vec3 colour{1.0f};  ///< 0..1, linear; the texture is multiplied by it
  int texture = -1;        ///< an index into Appearance::textures; -1: none
};

/// The look of a mesh that was read.  Nothing in it shapes a fracture.
struct Appearance {
  SurfaceLook surface;
  std::vector<Material> materials;  ///< empty where the file names none
  std::vector<Texture> textures;
};

/// The colour of what a fracture lays bare, sRGB.
inline constexpr glm::u8vec3 kInsideColour{224, 214, 196};

/// What kind of picture a file's bytes are, by their beginning.
enum class ImageType { png, jpeg, other };
[[nodiscard]] ImageType imageType(std::string_view bytes);

/// sRGB's transfer function and its inverse, by channel; 0..1 are linear light.
[[nodiscard]] glm::vec3 linearFromSrgb(glm::u8vec3 colour);
[[nodiscard]] glm::u8vec3 srgbFromLinear(glm::vec3 colour);  ///< what is outside 0..1 is clamped

}  // namespace sherd
