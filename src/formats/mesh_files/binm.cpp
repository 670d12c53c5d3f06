// Writes meshes as the paper's `.binm`: positions and faces.
//
//     u32 V | f32 x, y, z, thirteen 0, of each vertex | u32 F | u32 a, b, c, 0, of each face
#include "formats/mesh_files/binm.h"

#include "base/little_endian.h"
#include "formats/mesh/piece_mesh.h"

namespace sherd {

void writePieceBinm(const OutputFile& file, const PieceMesh& piece) {
  const TriangleMesh& mesh = piece.mesh;
  std::string bytes;
  bytes.reserve(8 + 64 * mesh.vertices.size() + 16 * mesh.triangles.size());
  storeLittle(bytes, static_cast<std::uint32_t>(mesh.vertices.size()));
  for (const glm::dvec3& v : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) storeLittle(bytes, static_cast<float>(v[axis]));
    bytes.append(13 * sizeof(float), '\0');
  }
  storeLittle(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) storeLittle(bytes, std::uint32_t{t[k]});
    storeLittle(bytes, std::uint32_t{0});
  }
  file.write(bytes);
}

}  // namespace sherd
