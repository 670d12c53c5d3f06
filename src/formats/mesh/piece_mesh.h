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

}  // namespace sherd
