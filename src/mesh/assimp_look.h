// What Assimp tells of the look of a glTF file.
#pragma once

#include <assimp/mesh.h>
#include <assimp/scene.h>

#include <cstdint>
#include <vector>

#include "mesh/mesh_reader.h"

namespace sherd {

/// What a scene has, and which of our materials its materials are.
struct AssimpLook {
  bool texcoords = false, colours = false;
  std::vector<std::uint32_t>
      material;                       ///< [materials of the scene], empty where none says anything
  std::vector<unsigned> texcoordSet;  ///< [materials of the scene] that of the base colour
};

/// Materials and textures of the scene, added to `look`: pictures in the file as they are, others
/// from beside it.
[[nodiscard]] AssimpLook lookOf(const MeshFile& file, const aiScene& scene, Appearance& look);

/// Add the look of a mesh whose vertices and triangles are the last of `out`.  Where it lacks what
/// others have, colours are white and texture coordinates 0.
void appendLook(const aiMesh& mesh, const AssimpLook& look, RawMesh& out);

}  // namespace sherd
