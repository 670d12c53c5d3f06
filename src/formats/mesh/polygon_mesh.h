// Meshes whose faces have any number of corners; attributes are per vertex, corner or face.
#pragma once

#include <cstdint>
#include <glm/gtc/type_precision.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

struct PolygonMesh {
  std::vector<glm::dvec3> vertices;
  std::vector<std::uint32_t> corners;   ///< vertices, below vertices.size(), face after face
  std::vector<std::uint32_t> faceEnds;  ///< [faces] one past a face's last corner; a face has at
                                        ///< least three

  // Each of these may be empty.
  std::vector<glm::u8vec3> vertexColors;     ///< [vertices]
  std::vector<glm::u8vec3> faceColors;       ///< [faces], where vertices have none
  std::vector<glm::vec2> vertexTexcoords;    ///< [vertices]
  std::vector<glm::vec2> cornerTexcoords;    ///< [corners], where vertices have none
  std::vector<glm::vec3> vertexNormals;      ///< [vertices] of any length
  std::vector<glm::vec3> cornerNormals;      ///< [corners], where vertices have none
  std::vector<std::uint32_t> faceMaterials;  ///< [faces]
  std::vector<std::uint16_t> faceNeighbors;  ///< [faces]
  std::vector<std::uint32_t> objectOfFace;   ///< [faces]
  std::vector<std::uint32_t> faceIndices;    ///< [faces] in the file; set if faces are left out

  std::uint32_t facesLeftOut = 0;  ///< of the file

  /// Bytes of all of these.
  [[nodiscard]] std::uint64_t bytes() const;

  /// Adds a face of the corners that were added since the last one.
  void endFace();

  /// Counts a face of the file that is left out.
  void leaveOutFace();
};

/// Appends the faces, as triangles with their attributes, to `out`, which has no triangle yet.
///   file    for the message, and charged with the triangles
///   throws  Error(input) more vertices or corners than 32 bits can count, or than memory holds
void triangulateInto(const MeshFile& file, PolygonMesh&& mesh, RawMesh& out);

}  // namespace sherd
