// Meshes that a glTF file holds packed by Draco.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mesh/gltf_accessor.h"

namespace sherd {

struct GltfDraco {
  std::map<std::string, GltfArray> attributes;  ///< by their names in glTF
  std::vector<glm::uvec3> triangles;            ///< below the length of each of these; what else
                                                ///< the primitive has may be of another
};

/// What a primitive's extension KHR_draco_mesh_compression stands for.
///   returns  none where it has none, or where its positions are there unpacked as well
///   throws  Error(input) data that Draco does not decode, or counts far beyond them
[[nodiscard]] std::optional<GltfDraco> decodeDraco(const GltfDocument& document,
                                                   const GltfDocument::Json& primitive);

}  // namespace sherd
