// Writes meshes as STL, binary and text.
//
//     80 bytes of text | u32 triangles | normal, three corners, u16 0 for each
#include "formats/mesh_files/stl.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "base/little_endian.h"
#include "base/text/number_text.h"
#include "base/text/safe_name.h"
#include "formats/mesh/piece_mesh.h"

namespace sherd {
namespace {

// The header must not begin with "solid": readers assume text then.
constexpr std::size_t kTitleBytes = 80;

glm::vec3 normalOf(const TriangleMesh& mesh, const glm::uvec3& t) {
  const glm::dvec3& a = mesh.vertices[t.x];
  const glm::dvec3 normal = glm::cross(mesh.vertices[t.y] - a, mesh.vertices[t.z] - a);
  const double length = glm::length(normal);
  return length > 0.0 ? glm::vec3(normal / length) : glm::vec3(0.0f);
}

void store(std::string& bytes, const glm::vec3& v) {
  for (int axis = 0; axis < 3; ++axis) storeLittle(bytes, v[axis]);
}

}  // namespace

void writePieceStl(const OutputFile& file, const PieceMesh& piece) {
  const TriangleMesh& mesh = piece.mesh;
  std::string bytes(kTitleBytes, '\0');
  const std::string name = "Sherd " + piece.name;
  std::copy_n(name.begin(), std::min(name.size(), kTitleBytes), bytes.begin());
  bytes.reserve(kTitleBytes + 4 + 50 * mesh.triangles.size());
  storeLittle(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const glm::uvec3& t : mesh.triangles) {
    store(bytes, normalOf(mesh, t));
    for (int k = 0; k < 3; ++k) store(bytes, glm::vec3(mesh.vertices[t[k]]));
    storeLittle(bytes, std::uint16_t{0});
  }
  file.write(bytes);
}

void writePieceStlText(const OutputFile& file, const PieceMesh& piece) {
  const std::string name = withoutBlanks(piece.name);
  std::string text = "solid " + name + "\n";
  for (const glm::uvec3& t : piece.mesh.triangles) {
    appendVector(text += " facet normal", normalOf(piece.mesh, t));
    text += "\n  outer loop\n";
    for (int k = 0; k < 3; ++k) {
      appendVector(text += "   vertex", piece.mesh.vertices[t[k]], piece.isDouble);
      text += "\n";
    }
    text += "  endloop\n endfacet\n";
  }
  file.write(text + "endsolid " + name + "\n");
}

}  // namespace sherd
