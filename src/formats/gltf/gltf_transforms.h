// Transforms of textures in glTF materials.
#pragma once

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// Applies KHR_texture_transform to the texture coordinates of a material's triangles, where all
/// its textures have the same: other formats have no transforms.  Where they differ the transforms
/// stay in Material::gltf, with a warning, since only glTF shows them.
///   mesh  as read, with materials
void applyTextureTransforms(const MeshFile& file, RawMesh& mesh);

}  // namespace sherd
