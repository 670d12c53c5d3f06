// Writes the meshes of a fracture with the surface attributes of the input mesh.
#pragma once

#include <sherd/folder.h>

#include <string>

#include "appearance/transfer.h"
#include "folder/files/copied_files.h"
#include "folder/manifest/manifest.h"
#include "formats/mesh/materials.h"
#include "formats/mesh/piece_mesh.h"
#include "formats/mesh/scene.h"

namespace sherd {

/// Writes meshes into a folder, from any thread.  Holds references to the arguments of its
/// constructor.
class MeshWriter {
 public:
  /// Writes the files to which meshes refer: material library and textures.
  ///   attributes  of the source; null if it has none and source faces are not
  ///               written
  ///   solid       that the source became
  ///   coordinates of the meshes
  MeshWriter(const OutputFolder& folder, const FractureFiles& files, const SourceMesh& source,
             const MaterialTable& table, const AttributeSource* attributes, const Solid& solid,
             const WriteOptions& write, const CoordinateSystem& coordinates);

  /// Transfers the source's surface attributes to a mesh; empty if it has none.
  SurfaceAttributes attributesOf(const TriangleMesh& mesh) const;

  /// Writes a mesh in all formats.
  ///   attributes  attributesOf the mesh
  ///   paths       [formats] in the folder
  ///   isDouble    vertices have double precision, in formats that hold it
  void write(const TriangleMesh& mesh, const SurfaceAttributes& attributes,
             const std::vector<std::string>& paths, bool isDouble) const;

  /// The same of a fragment; copies the files that are kept.
  void write(const Fragment& fragment, const SurfaceAttributes& attributes,
             const std::vector<std::string>& paths, bool isDouble, const CopiedFiles& kept) const;

  /// Writes all fragments as scenes: one .glb, and USD in all formats.
  ///   attributes  [fragments] attributesOf their meshes
  ///   splits      of the fracture, the withheld fragments' included
  ///   voxelSize   of the level sets in the .vdb files
  void writeScenes(std::span<const Fragment> fragments,
                   std::span<const SurfaceAttributes> attributes, std::span<const Split> splits,
                   const FractureFiles& files, double voxelSize, const Progress* progress) const;

  /// Writes all fragments as polygons of one file for Houdini.
  ///   attributes  [fragments] attributesOf their meshes
  ///   splits      of the fracture, the withheld fragments' included
  ///   paths       in the folder: of the meshes, then of each number of triangles
  void writeHoudini(std::span<const Fragment> fragments,
                    std::span<const SurfaceAttributes> attributes, std::span<const Split> splits,
                    const std::vector<std::string>& paths, const Progress* progress) const;

 private:
  // The coarse meshes of fragments with their attributes.
  struct Levels {
    std::vector<std::vector<const TriangleMesh*>> meshes;    // [fragments][levels]
    std::vector<std::vector<SurfaceAttributes>> attributes;  // of each
  };
  // Returns those that have fewer triangles than the mesh and the level before, the finest first;
  // all fragments have as many.
  Levels levelsOf(std::span<const Fragment> fragments) const;

  void writeAs(MeshFileFormat format, const std::string& path, const PieceMesh& piece) const;
  std::vector<std::int32_t> facesOf(const TriangleMesh& mesh) const;
  // Returns [fragments] the names of their files.
  std::vector<std::string> namesOf(std::span<const Fragment> fragments) const;
  //   names   [fragments] to which the scene refers
  //   levels  the same
  FragmentScene sceneOf(std::span<const Fragment> fragments,
                        std::span<const SurfaceAttributes> attributes,
                        std::span<const std::string> names, const Levels& levels,
                        std::span<const Split> splits, const FractureFiles& files,
                        double voxelSize) const;

  const OutputFolder& folder_;
  const MaterialTable& table_;
  const WriteOptions& options_;
  const CoordinateSystem coordinates_;
  const AttributeSource* attributes_;
  const Solid& solid_;
  PieceInput input_;
  std::string library_;  ///< file name of the material library
  std::string stem_;     ///< of node names
};

}  // namespace sherd
