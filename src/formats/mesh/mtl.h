// Material libraries of OBJ files.
#pragma once

#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <string_view>

namespace sherd {

/// What a library tells of a material.
struct MtlMaterial {
  glm::vec3 colour{1.0f};  ///< Kd
  std::string texture;     ///< map_Kd, without its options; empty: none
};

/// Add the materials of a library's text by their names; of two of one name the first counts.
/// Lines that make no sense are passed over.
void addMtl(std::string_view text, std::map<std::string, MtlMaterial>& materials);

}  // namespace sherd
