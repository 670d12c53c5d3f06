// Writes the meshes of a fracture, with the look of the mesh that was broken.
#pragma once

#include <sherd/io.h>

#include <string>

#include "appearance/transfer.h"
#include "folder/manifest.h"
#include "formats/mesh/materials.h"
#include "formats/mesh/piece_mesh.h"

namespace sherd {

/// Writes meshes into a folder; any thread may ask.  What it is made of is kept by reference.
class MeshWriter {
 public:
  /// Writes what meshes refer to: the library of materials and the textures.
  ///   look  of the source, or null where it has none
  MeshWriter(const OutputFolder& folder, const FractureFiles& files, const SourceMesh& source,
             const MaterialTable& table, const LookSource* look, const WriteOptions& write);

  /// What a mesh takes over of the source's look; empty where that has none.
  SurfaceLook lookOf(const TriangleMesh& mesh, const std::vector<std::uint16_t>& facing) const;

  ///   look   lookOf the mesh
  ///   paths  [formats] in the folder
  void write(const TriangleMesh& mesh, const std::vector<std::uint16_t>& facing,
             const SurfaceLook& look, const std::vector<std::string>& paths) const;

  /// All of them as nodes of one .glb, named as their own meshes' files would be.
  ///   looks  [fragments] lookOf their meshes
  ///   path   in the folder
  void writeScene(std::span<const Fragment> fragments, std::span<const SurfaceLook> looks,
                  const std::string& path) const;

 private:
  const OutputFolder& folder_;
  const MaterialTable& table_;
  const WriteOptions& options_;
  const LookSource* look_;
  std::string library_;  ///< its file name
  std::string stem_;     ///< of nodes
};

}  // namespace sherd
