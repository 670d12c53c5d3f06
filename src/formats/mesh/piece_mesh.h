// A fragment's mesh as it is written to files.
#pragma once

#include <sherd/files.h>
#include <sherd/mesh.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/materials.h"

namespace sherd {

/// The input of an exact surface, to whose triangles TriangleMesh::source refers.
struct PieceInput {
  const SourceMesh& source;
  std::vector<std::string> groups;  ///< groupNames(source)
};

/// The data of a fragment's mesh that is written, in any format.
struct PieceMesh {
  const std::string& name;  ///< object name, in formats that have one
  const TriangleMesh& mesh;
  const SurfaceAttributes& attributes;  ///< of `mesh`, its own or transferred to it
  const MaterialTable& materials;
  bool isDouble = false;  ///< writes vertices in double precision, in PLY, OBJ and text STL
  const PieceInput* input = nullptr;  ///< null: polygons and objects of the input are not written
  std::span<const std::int32_t> sourceFaces{};  ///< [triangles] see sourceFaces, or empty; in PLY
  CoordinateSystem coordinates{};               ///< of `mesh`; in glTF

  /// Returns the normal of a triangle's corner if `attributes` have one, else zero.
  [[nodiscard]] glm::vec3 normalOf(std::size_t triangle, std::size_t corner) const {
    return attributes.normals.empty() ? glm::vec3(0.0f) : attributes.normals[triangle][corner];
  }

  /// Returns whether a triangle is of the original surface, and does not close a hole of it.
  [[nodiscard]] bool isOriginal(std::size_t triangle) const {
    if (mesh.neighborOf(triangle) != 0) return false;
    return mesh.source.empty() || mesh.source[triangle] != TriangleMesh::kNoSource;
  }

  /// Returns the triangle's material in the table: that of the inside also where it closes a hole.
  [[nodiscard]] std::uint32_t materialOf(std::size_t triangle) const {
    if (!attributes.material.empty()) return attributes.material[triangle];
    return isOriginal(triangle) ? 0 : materials.inside();
  }
};

/// Returns the neighbor of each vertex: 0 if all faces around it are original surface, else the id
/// whose faces have the largest sum of angles at the vertex; of equal sums the lower id.
///   return  [vertices]
[[nodiscard]] std::vector<std::uint16_t> vertexNeighbor(const TriangleMesh& mesh);

/// Returns the normal of each vertex: that of its corners if all have the same, else their mean,
/// weighted by their angles.  Corners have the normals of piece.attributes, else their face's.
///   return  [vertices] unit, or zero if they cancel
[[nodiscard]] std::vector<glm::dvec3> meanNormals(const PieceMesh& piece);

/// The corners of a mesh for formats whose vertices have one normal and one set of attributes: a
/// vertex is repeated for each neighbor, texture coordinate and color, and with
/// TriangleMesh::source or isMerged for each side of a crease.
struct SplitCorners {
  struct Corner {
    std::uint32_t vertex = 0;
    std::uint32_t normal = 0;  ///< an index into normals
    std::uint16_t neighbor = 0;
    glm::vec2 texcoord{0.0f};
    glm::u8vec3 color{255};
    bool operator==(const Corner&) const = default;
  };
  std::vector<Corner> corners;
  std::vector<glm::dvec3> normals;  ///< unit; as in piece.attributes, else the mean over faces
                                    ///< around the vertex with one neighbor, or one of its
                                    ///< creaseGroups
  std::vector<std::array<std::uint32_t, 3>> ofTriangle;  ///< [triangles]
};
[[nodiscard]] SplitCorners splitCorners(const PieceMesh& piece);

/// Returns the normals of the same corners, with four digits behind the point, for text: half of
/// the last is 0.003 degrees.
///   return  [triangles]
[[nodiscard]] std::vector<std::array<glm::vec3, 3>> shortNormals(const PieceMesh& piece);

/// Writes binary little-endian PLY with one vertex for each of the mesh's, so it stays closed.
/// With PieceMesh::input its polygons are one face each where they are whole.
///   throws  Error(output), as all of them
void writePiecePly(const OutputFile& file, const PieceMesh& piece);

/// Writes OBJ with normals, and with texture coordinates and colors if present.  With
/// PieceMesh::input its polygons are one face each where they are whole, and its objects are
/// groups, beside a group "inside".
///   library  the file of mtlText(piece.materials), beside it; empty: no materials are named
void writePieceObj(const OutputFile& file, const PieceMesh& piece, const std::string& library);

/// Returns whether vertices can be written in double precision.
[[nodiscard]] inline bool holdsDoubles(MeshFileFormat format) {
  return format == MeshFileFormat::ply || format == MeshFileFormat::obj ||
         format == MeshFileFormat::stlText;
}

/// Writes PLY, OBJ and binary glTF with vertices and triangles only.
void writePlainPly(const OutputFile& file, const TriangleMesh& mesh, bool isDouble = false);
void writePlainObj(const OutputFile& file, const TriangleMesh& mesh, bool isDouble = false);
void writePlainGlb(const OutputFile& file, const std::string& name, const TriangleMesh& mesh,
                   const CoordinateSystem& coordinates);

/// Writes binary STL: triangles with their normals only.
void writePieceStl(const OutputFile& file, const PieceMesh& piece);

/// Writes text STL.
void writePieceStlText(const OutputFile& file, const PieceMesh& piece);

/// Writes the paper's `.binm`: positions and faces only.
void writePieceBinm(const OutputFile& file, const PieceMesh& piece);

/// Writes a mesh in a format, by the functions above or writePieceGlb.
///   library  of materials, for OBJ; see writePieceObj
///   throws   Error(output)
void writePiece(const OutputFile& file, MeshFileFormat format, const PieceMesh& piece,
                const std::string& library);

/// Writes binary glTF 2.0 with embedded PNG and JPEG textures: one node with one mesh, see
/// addGlbMesh, below one that converts coordinates to glTF's where they are not.
void writePieceGlb(const OutputFile& file, const PieceMesh& piece);

}  // namespace sherd
