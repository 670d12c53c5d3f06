// Materials of a glTF file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/gltf/gltf_document.h"

namespace sherd {

/// Returns the set of texture coordinates of a material's base color, or of its first texture if
/// that has none; 0 if it has no texture.
///   material    an index into the file's materials, or their number for none
[[nodiscard]] std::size_t texcoordSetOf(const GltfDocument& document, std::size_t material);

/// Adds the used materials, with their textures, to `out`. Embedded images are named by their
/// number among these; others are read from beside the file.
///   used      [materials of the file + 1] the last is for faces without a material
///   textured  whether there are texture coordinates; else textures are left out
///   returns   [materials of the file + 1] indices in `out`; empty if no material has a name or a
///             property
[[nodiscard]] std::vector<std::uint32_t> addMaterials(const GltfDocument& document,
                                                      const std::vector<bool>& used, bool textured,
                                                      RawMesh& out);

}  // namespace sherd
