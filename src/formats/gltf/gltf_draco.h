// Meshes that a glTF file holds compressed by Draco.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "formats/gltf/gltf_accessor.h"

namespace sherd {

struct GltfDraco {
  std::map<std::string, GltfArray> attributes;  ///< by name in glTF
  std::vector<glm::uvec3> triangles;            ///< below the length of each of these; the
                                                ///< primitive's others may differ in length
};

/// Decodes the extension KHR_draco_mesh_compression of a primitive.
///   names    attributes that are decoded if present; others may be of any size
///   returns  nothing if it is absent, or if positions are also stored uncompressed
///   throws  Error(input) data that Draco cannot decode, counts far beyond its size, more than
///           memory holds
[[nodiscard]] std::optional<GltfDraco> decodeDraco(const GltfDocument& document,
                                                   const GltfDocument::Json& primitive,
                                                   const std::set<std::string>& names);

}  // namespace sherd
