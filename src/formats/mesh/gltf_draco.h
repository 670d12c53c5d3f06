// Meshes that a glTF file holds packed by Draco.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "formats/mesh/gltf_accessor.h"

namespace sherd {

struct GltfDraco {
  std::map<std::string, GltfArray> attributes;  ///< by their names in glTF
  std::vector<glm::uvec3> triangles;            ///< below the length of each of these; what else
                                                ///< the primitive has may be of another
};

/// What a primitive's extension KHR_draco_mesh_compression stands for.
///   names    attributes that are unpacked if it has them; others may be of any size
///   returns  none where it has none, or where its positions are there unpacked as well
///   throws  Error(input) data that Draco does not decode, counts far beyond them, or more than
///   memory holds
[[nodiscard]] std::optional<GltfDraco> decodeDraco(const GltfDocument& document,
                                                   const GltfDocument::Json& primitive,
                                                   const std::set<std::string>& names);

}  // namespace sherd
