// Materials of a glTF file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/mesh/gltf_document.h"

namespace sherd {

/// Which texture coordinates a material's base colour takes; 0 where it has no texture.
///   material    an index into the file's, or their number for none
[[nodiscard]] std::size_t texcoordSetOf(const GltfDocument& document, std::size_t material);

/// Add the materials that are used, with their textures, to `out`.  Pictures in the file are named
/// by their number among these, others are read from beside it.
///   used      [materials of the file + 1] the last stands for faces without one
///   textured  whether there are texture coordinates; else textures are left out
///   returns   [materials of the file + 1] what each is in `out`; empty where none says anything
[[nodiscard]] std::vector<std::uint32_t> addMaterials(const GltfDocument& document,
                                                      const std::vector<bool>& used, bool textured,
                                                      RawMesh& out);

}  // namespace sherd
