// Sheets that a mesh has from both sides, as leaves and cards have.
#pragma once

#include <sherd/mesh.h>
#include <sherd/progress.h>

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace sherd {

/// A triangle of a sheet, with the triangles of the mesh that show there.
struct SheetFace {
  glm::uvec3 corners{0};         ///< counterclockwise from the front
  std::uint32_t front = 0;       ///< the mesh's triangle
  std::uint32_t back = 0;        ///< the one behind
  std::uint32_t group = 0;       ///< of flat faces, consecutive and from 1, whose other side has as
                                 ///< many triangles; 0: none
  std::uint32_t groupSize = 0;   ///< faces of the group
  std::uint32_t other = 0;       ///< one of these triangles, each once
  bool isBetweenOthers = false;  ///< all edges around the sheet are edges of other triangles too
};

/// Flat sheets whose sides have other triangles, as a quad's do that are split by both diagonals.
struct FlatSheets {
  std::vector<SheetFace> faces;          ///< by the triangles of one side
  std::vector<std::uint32_t> triangles;  ///< of the mesh, both sides, ascending
};

/// Returns the flat sheets among some triangles: those that lie in a plane, are connected over
/// edges there, and have each edge as often in one direction as in the other.
///   among  ascending
[[nodiscard]] FlatSheets flatSheets(const TriangleMesh& mesh, std::span<const std::uint32_t> among);

/// Returns the triangles of components of which a flat sheet could be one: those of few triangles.
[[nodiscard]] std::vector<std::uint32_t> ofSmallComponents(const MeshComponents& components);

/// Leaves out faces that lie inside the rest of the mesh, or in a hole of it.
///   rest  the mesh without sheets, oriented outwards; may be empty
void keepOutside(std::vector<SheetFace>& faces, const TriangleMesh& rest, const Progress* progress);

/// Whether sheets are a few doubled faces beside what the rest of a mesh has.
[[nodiscard]] bool areFew(std::span<const SheetFace> faces, const TriangleMesh& rest);

}  // namespace sherd
