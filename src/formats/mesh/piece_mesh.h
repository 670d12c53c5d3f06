// A fragment's mesh as its files hold it.
#pragma once

#include <sherd/appearance.h>
#include <sherd/mesh.h>
#include <sherd/mesh_files.h>
#include <sherd/output_file.h>

#include <array>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/materials.h"

namespace sherd {

/// What is written of a fragment's mesh, in any format.
struct PieceMesh {
  const std::string& name;  ///< of the object in formats that name it
  const TriangleMesh& mesh;
  const std::vector<std::uint16_t>& facing;  ///< [triangles]
  const SurfaceLook& look;                   ///< of `mesh`; arrays may be empty
  const MaterialTable& materials;

  /// The triangle's material in the table.
  [[nodiscard]] std::uint32_t materialOf(std::size_t triangle) const {
    if (!look.material.empty()) return look.material[triangle];
    return facing[triangle] == 0 ? 0 : materials.inside();
  }
};

/// What the faces round each vertex face: 0 where all are of the original surface, else the id that
/// they face most of those that are not 0, by their angles at the vertex; of two alike the lower.
///   return  [vertices]
[[nodiscard]] std::vector<std::uint16_t> vertexFacing(const TriangleMesh& mesh,
                                                      const std::vector<std::uint16_t>& facing);

/// The corners of a mesh for formats whose vertices have one normal and one look each: a vertex is
/// there once for each thing that it faces, texture coordinate and colour.
struct SplitCorners {
  struct Corner {
    std::uint32_t vertex = 0;
    std::uint32_t normal = 0;  ///< an index into normals
    std::uint16_t facing = 0;
    glm::vec2 texcoord{0.0f};
    glm::u8vec3 colour{255};
    bool operator==(const Corner&) const = default;
  };
  std::vector<Corner> corners;
  std::vector<glm::dvec3> normals;  ///< unit: over the faces round the vertex that face the same
  std::vector<std::array<std::uint32_t, 3>> ofTriangle;  ///< [triangles]
};
[[nodiscard]] SplitCorners splitCorners(const PieceMesh& piece);

/// Binary little-endian PLY; one vertex for each of the mesh's, so it stays closed.
///   throws  Error(output), as all of them
void writePiecePly(const OutputFile& file, const PieceMesh& piece);

/// OBJ with normals, and texture coordinates and colours where there are some.
///   library  the file of mtlText(piece.materials), beside it; empty: no materials are named
void writePieceObj(const OutputFile& file, const PieceMesh& piece, const std::string& library);

/// OBJ of vertices and triangles alone.
void writePlainObj(const OutputFile& file, const TriangleMesh& mesh);

/// Binary STL: the triangles alone, with their normals.
void writePieceStl(const OutputFile& file, const PieceMesh& piece);

/// The same as text.
void writePieceStlText(const OutputFile& file, const PieceMesh& piece);

/// The paper's `.binm`: positions and faces alone.
void writePieceBinm(const OutputFile& file, const PieceMesh& piece);

/// Write a mesh in a format, by the functions above or writePieceGlb.
///   library  of materials, for OBJ; see writePieceObj
///   throws   Error(output)
void writePiece(const OutputFile& file, MeshFileFormat format, const PieceMesh& piece,
                const std::string& library);

/// A piece of a scene.
struct SceneNode {
  PieceMesh piece;
  MassProperties mass;
};

/// Binary glTF 2.0 of several pieces that have one table of materials: a node for each at its
/// centre of mass, with mass and inertia as the extension KHR_physics_rigid_bodies has them.
///   density  mass of a unit of volume
void writeSceneGlb(const OutputFile& file, std::span<const SceneNode> nodes, double density);

/// Binary glTF 2.0 with its PNG and JPEG textures in it; one node, a primitive for each material.
void writePieceGlb(const OutputFile& file, const PieceMesh& piece);

}  // namespace sherd
