// Material libraries of OBJ files.
#pragma once

#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <string_view>

namespace sherd {

/// The properties of a material in a library.
struct MtlMaterial {
  glm::vec3 color{1.0f};  ///< Kd
  std::string texture;    ///< map_Kd, without its options; empty: none
};

/// Adds the materials of a library's text by name; of two with one name the first counts. Malformed
/// lines are skipped.
void addMtl(std::string_view text, std::map<std::string, MtlMaterial>& materials);

}  // namespace sherd
