// A fragment's mesh as a prim of USD.
#pragma once

#include <functional>
#include <string>

#include "formats/mesh/piece_mesh.h"
#include "formats/usd/usd_text.h"

namespace sherd {

/// Returns the line of a prim's box, that of a mesh.
///   origin  of the prim, in the mesh's coordinates
///   unit    of the prim, in that of the mesh
[[nodiscard]] std::string usdExtent(const TriangleMesh& mesh, const glm::dvec3& origin,
                                    double unit = 1.0);

/// Writes a mesh as a prim with a convex hull as its collider, and its faces' materials as subsets.
///   origin        of the prim, in the mesh's coordinates
///   materialPath  of a number of piece.materials; null: vertices, triangles and collider only
void writeUsdMesh(UsdText& text, const std::string& name, const PieceMesh& piece,
                  const glm::dvec3& origin,
                  const std::function<std::string(std::uint32_t)>& materialPath);

}  // namespace sherd
