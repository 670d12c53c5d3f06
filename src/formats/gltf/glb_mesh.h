// The meshes of a glTF file that is written.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <string>

#include "formats/gltf/glb_file.h"
#include "formats/gltf/glb_materials.h"
#include "formats/mesh/piece_mesh.h"

namespace sherd {

/// Adds a mesh to a file: one set of vertices, which are split where their neighbor, normal, color
/// or texture coordinates differ, and for each material a primitive, which has a range of one list
/// of indices. With the extension EXT_mesh_manifold, if the mesh is closed and edge-manifold: the
/// indices after merging the vertices that were split.
///   origin  of the mesh's coordinates in those of the piece
///   return  its number
std::size_t addGlbMesh(GlbFile& file, GlbMaterials& materials, const PieceMesh& piece,
                       const glm::dvec3& origin = glm::dvec3(0.0));

/// Adds a mesh as positions and triangles of one primitive without a material, whose vertices are
/// those of the mesh.
std::size_t addPlainGlbMesh(GlbFile& file, const std::string& name, const TriangleMesh& mesh,
                            const glm::dvec3& origin = glm::dvec3(0.0));

}  // namespace sherd
