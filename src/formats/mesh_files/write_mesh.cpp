// Writes a mesh in any format.
#include "formats/mesh_files/write_mesh.h"

#include "formats/gltf/glb.h"
#include "formats/mesh_files/binm.h"
#include "formats/mesh_files/stl.h"
#include "formats/obj/obj.h"
#include "formats/ply/ply.h"

namespace sherd {

void writePiece(const OutputFile& file, MeshFileFormat format, const PieceMesh& piece,
                const std::string& library) {
  switch (format) {
    case MeshFileFormat::ply:
      return writePiecePly(file, piece);
    case MeshFileFormat::obj:
      return writePieceObj(file, piece, library);
    case MeshFileFormat::glb:
      return writePieceGlb(file, piece);
    case MeshFileFormat::stl:
      return writePieceStl(file, piece);
    case MeshFileFormat::stlText:
      return writePieceStlText(file, piece);
    case MeshFileFormat::binm:
      return writePieceBinm(file, piece);
  }
}

}  // namespace sherd
