// Writes a mesh in any format.
#include "formats/mesh/write_mesh.h"

#include "formats/mesh/binm.h"
#include "formats/mesh/glb.h"
#include "formats/mesh/obj.h"
#include "formats/mesh/ply.h"
#include "formats/mesh/stl.h"

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
