// Checks that a reader's result is consistent.
#pragma once

#include <optional>
#include <string>

#include "formats/mesh/mesh_reader.h"

namespace sherd {

/// What a reader's result and a merged mesh have.
struct MeshParts {
  const std::vector<glm::dvec3>& vertices;
  const std::vector<glm::uvec3>& triangles;
  const SurfaceAttributes& attributes;
  const std::vector<std::uint16_t>& neighbor;
  const Appearance& appearance;
  const std::vector<std::string>& objects;
  const std::vector<std::uint32_t>& objectOfTriangle;
  const std::vector<PolygonPart>& polygons;
};

/// Returns the first violation of RawMesh's invariants: an index out of range, an array whose
/// length is not the number of triangles, a texture coordinate that is not finite; nothing if there
/// is none. Linear in the mesh.
[[nodiscard]] std::optional<std::string> contradictionIn(const MeshParts& mesh);
[[nodiscard]] std::optional<std::string> contradictionIn(const RawMesh& mesh);

/// The same of a mesh after merging: also a vertex or color that is not finite, a triangle with
/// equal corners, a normal that is no unit vector, a material that is not JSON, too long a mesh.
[[nodiscard]] std::optional<std::string> contradictionIn(const SourceMesh& source);

/// Returns "is 1e+40 long along x, at most 1e37 is supported (scale it)" for a mesh whose lengths
/// would overflow in single precision, or whose squares would in double precision.
[[nodiscard]] std::optional<std::string> tooLong(const TriangleMesh& mesh);

}  // namespace sherd
