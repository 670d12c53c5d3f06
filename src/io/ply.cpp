// Meshes as binary little-endian PLY.
#include <sherd/io.h>

#include <cassert>
#include <string>

#include "io/atomic_file.h"
#include "io/little_endian.h"

namespace sherd {

void writePly(const std::filesystem::path& file, const TriangleMesh& mesh,
              const std::vector<std::uint16_t>& facing) {
  assert(facing.empty() || facing.size() == mesh.triangles.size());
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\n"
      "element vertex " +
      std::to_string(mesh.vertices.size()) +
      "\n"
      "property float x\nproperty float y\nproperty float z\n"
      "element face " +
      std::to_string(mesh.triangles.size()) +
      "\n"
      "property list uchar int vertex_indices\n" +
      (facing.empty() ? "" : "property int facing\n") + "end_header\n";
  bytes.reserve(bytes.size() + mesh.vertices.size() * 12 +
                mesh.triangles.size() * (facing.empty() ? 13 : 17));
  for (const glm::dvec3& v : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) storeLittle(bytes, static_cast<float>(v[axis]));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    storeLittle(bytes, std::uint8_t{3});
    for (int corner = 0; corner < 3; ++corner) storeLittle(bytes, mesh.triangles[t][corner]);
    if (!facing.empty()) storeLittle(bytes, std::uint32_t{facing[t]});
  }
  writeWhole(file, bytes);
}

}  // namespace sherd
