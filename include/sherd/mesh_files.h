// Fragments' meshes as files.
#pragma once

#include <sherd/mesh.h>
#include <sherd/output_file.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// How fragments' meshes are written.  Where the mesh that was broken has a look, the first three
/// hold it: the original surface's is that of the nearest part of it; what the fracture laid bare
/// has kInsideColour and a material "inside".
enum class MeshFileFormat {
  ply,      ///< as writePly, and colours of vertices, texture coordinates and material of faces
  obj,      ///< with normals and materials; the library of materials, one for all, lies beside it
  glb,      ///< binary glTF 2.0 with its textures in it; a primitive for each material
  stl,      ///< binary; the triangles alone
  stlText,  ///< the same as text, into files of the same name
  binm,     ///< the paper's: positions and faces alone
};

/// Write a mesh as binary little-endian PLY: float x, y, z; faces of three.  Where `facing` is
/// given, faces have `int facing`, and vertices have it behind their normals, float nx, ny, nz:
/// normals are the mean of the faces round a vertex, weighted by their angles there; a vertex's
/// facing is 0 where all of these are of the original surface, else the id that they face most, by
/// the same angles, of those that are not 0.
void writePly(const OutputFile& file, const TriangleMesh& mesh,
              const std::vector<std::uint16_t>& facing = {});

}  // namespace sherd
