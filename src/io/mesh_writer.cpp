// Writes the meshes of a fracture, with the look of the mesh that was broken.
#include "io/mesh_writer.h"

#include "io/file_names.h"
#include "io/piece_mesh.h"

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

MeshWriter::MeshWriter(const OutputFolder& folder, const FractureFiles& files,
                       const SourceMesh& source, const MaterialTable& table, const LookSource* look,
                       const WriteOptions& write)
    : folder_(folder),
      table_(table),
      options_(write),
      look_(look),
      library_(std::filesystem::path(files.materials).filename().string()),
      stem_(safeName(source.stem, "piece")) {
  if (files.mesh.empty() && files.scene.empty()) return;
  if (!files.materials.empty()) (folder / files.materials).write(mtlText(table));
  for (std::size_t i = 0; i < files.textures.size(); ++i) {
    (folder / files.textures[i]).write(table.textures[i].bytes);
  }
}

SurfaceLook MeshWriter::lookOf(const TriangleMesh& mesh,
                               const std::vector<std::uint16_t>& facing) const {
  return look_ ? look_->on(mesh, facing, table_.inside()) : SurfaceLook();
}

void MeshWriter::write(const TriangleMesh& mesh, const std::vector<std::uint16_t>& facing,
                       const SurfaceLook& look, const std::vector<std::string>& paths) const {
  const std::string name = std::filesystem::path(paths.front()).stem().string();
  const PieceMesh piece{name, mesh, facing, look, table_};
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const MeshFileFormat format = options_.meshFormats[i];
    if (options_.plainMeshes && format == MeshFileFormat::ply) {
      writePly(folder_ / paths[i], mesh);
      continue;
    }
    if (options_.plainMeshes && format == MeshFileFormat::obj) {
      writePlainObj(folder_ / paths[i], mesh);
      continue;
    }
    writePiece(folder_ / paths[i], format, piece, library_);
  }
}

void MeshWriter::writeScene(std::span<const Fragment> fragments, std::span<const SurfaceLook> looks,
                            const std::string& path) const {
  std::vector<std::string> names;
  for (const Fragment& fragment : fragments) {
    names.push_back(pieceName(stem_, fragment.id, fragments.size()));
  }
  std::vector<SceneNode> nodes;
  for (std::size_t i = 0; i < fragments.size(); ++i) {
    const Fragment& fragment = fragments[i];
    nodes.push_back({{names[i], fragment.mesh, fragment.facing, looks[i], table_}, fragment.mass});
  }
  writeSceneGlb(folder_ / path, nodes, options_.density);
}

}  // namespace sherd
