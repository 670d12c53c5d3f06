// Meshes as binary STL.
//
//     80 bytes of text | u32 triangles | normal, three corners, u16 0 for each
#include <algorithm>
#include <glm/geometric.hpp>

#include "io/atomic_file.h"
#include "io/little_endian.h"
#include "io/piece_mesh.h"

namespace sherd {
namespace {

// Readers take a file that begins with "solid" for text.
constexpr std::size_t kHeader = 80;

void store(std::string& bytes, const glm::vec3& v) {
  for (int axis = 0; axis < 3; ++axis) storeLittle(bytes, v[axis]);
}

}  // namespace

void writePieceStl(const std::filesystem::path& file, const PieceMesh& piece) {
  const TriangleMesh& mesh = piece.mesh;
  std::string bytes(kHeader, '\0');
  const std::string name = "Sherd " + piece.name;
  std::copy_n(name.begin(), std::min(name.size(), kHeader), bytes.begin());
  bytes.reserve(kHeader + 4 + 50 * mesh.triangles.size());
  storeLittle(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 &a = mesh.vertices[t.x], &b = mesh.vertices[t.y], &c = mesh.vertices[t.z];
    const glm::dvec3 round = glm::cross(b - a, c - a);
    const double length = glm::length(round);
    store(bytes, length > 0.0 ? glm::vec3(round / length) : glm::vec3(0.0f));
    for (const glm::dvec3& corner : {a, b, c}) store(bytes, glm::vec3(corner));
    storeLittle(bytes, std::uint16_t{0});
  }
  writeWhole(file, bytes);
}

}  // namespace sherd
