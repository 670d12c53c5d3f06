// Mesh files of fragments.
#pragma once

#include <sherd/mesh.h>
#include <sherd/output_file.h>

#include <cstdint>
#include <vector>

namespace sherd {

/// Formats of fragments' meshes.  If the input has surface attributes, the first three hold them:
/// on the original surface those of the closest point of the input; fracture surfaces have
/// kInsideColor and the material "inside".
enum class MeshFileFormat {
  ply,      ///< as writePly, with vertex colors, and texture coordinates and material of faces
  obj,      ///< with normals and materials; one material library for all, in the same folder
  glb,      ///< binary glTF 2.0 with embedded textures, a primitive for each material
  stl,      ///< binary; triangles only
  stlText,  ///< the same as text, with the same file names
  binm,     ///< the paper's: positions and faces only
};

/// Writes a mesh as binary little-endian PLY: vertices float x, y, z; triangles.  Where its
/// neighbors are known, faces have `int neighbor`, and vertices have float nx, ny, nz and `int
/// neighbor`: normals are angle-weighted means over the faces at the vertex; a vertex's neighbor is
/// 0 if these faces are all on the original surface, else the id above 0 with the largest sum of
/// angles. Surface attributes are not written.
///   throws  Error(output)
void writePly(const OutputFile& file, const TriangleMesh& mesh);

}  // namespace sherd
