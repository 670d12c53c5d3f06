// Writes a mesh as binary glTF.
#include "formats/gltf/glb.h"

#include "formats/gltf/glb_file.h"
#include "formats/gltf/glb_materials.h"
#include "formats/gltf/glb_mesh.h"
#include "formats/mesh/piece_mesh.h"

namespace sherd {

void writePieceGlb(const OutputFile& file, const PieceMesh& piece) {
  GlbFile glb;
  GlbMaterials materials(glb, piece.materials);
  const std::size_t mesh = addGlbMesh(glb, materials, piece);
  glb.nodes.push_back({{"name", piece.name}, {"mesh", mesh}});
  glb.write(file, {0}, piece.coordinates, piece.name);
}

void writePlainGlb(const OutputFile& file, const std::string& name, const TriangleMesh& mesh,
                   const CoordinateSystem& coordinates) {
  GlbFile glb;
  glb.nodes.push_back({{"name", name}, {"mesh", addPlainGlbMesh(glb, name, mesh)}});
  glb.write(file, {0}, coordinates, name);
}

}  // namespace sherd
