// One primitive of a glTF file's mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/gtc/type_precision.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/gltf/gltf_document.h"

namespace sherd {

struct GltfPrimitive {
  std::vector<glm::dvec3> positions;
  std::vector<glm::uvec3> triangles;  ///< below positions.size()
  std::vector<glm::vec2> texcoords;   ///< [positions] v upwards, or empty
  std::vector<glm::u8vec3> colors;    ///< [positions] sRGB, or empty
  std::vector<glm::vec3> normals;     ///< [positions] as in the file, or empty
  std::vector<float> values;          ///< [positions] of MeshFile::attribute, or empty
  std::size_t material = 0;           ///< index into the file's materials, or their number

  /// Bytes of all of these.
  [[nodiscard]] std::uint64_t bytes() const;
};

/// Returns the names by which MeshFile::attribute may select values of a primitive: attributes that
/// begin with an underscore, without it, and `red green blue alpha` of COLOR_0.
[[nodiscard]] std::vector<std::string> valueNamesOf(const GltfDocument::Json& primitive);

/// Reads the triangles of a primitive: a list, strip or fan, indexed or not, compressed or not.
///   returns  nothing for points or lines
///   throws  Error(input) no positions, an index out of range, arrays of unequal length, more
///           memory than allowed; intermediate arrays are charged, too
[[nodiscard]] std::optional<GltfPrimitive> readGltfPrimitive(const GltfDocument& document,
                                                             const GltfDocument::Json& primitive);

}  // namespace sherd
