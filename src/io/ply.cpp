// Meshes as binary little-endian PLY.
#include <sherd/io.h>

#include <cassert>
#include <string>

#include "io/little_endian.h"
#include "io/piece_mesh.h"
#include "mesh/vertex_normals.h"

namespace sherd {
namespace {

/// Records of one kind, one after the other at the end of a file's bytes.
class Records {
 public:
  ///   most  bytes that all will take at most
  Records(std::string& bytes, std::size_t most) : bytes_(bytes) {
    const std::size_t size = bytes.size();
    bytes.resize(size + most);
    at_ = bytes.data() + size;
  }
  ~Records() { bytes_.resize(static_cast<std::size_t>(at_ - bytes_.data())); }
  Records(const Records&) = delete;
  Records& operator=(const Records&) = delete;

  template <class T>
  void put(T value) {
    keepLittle(at_, value);
    at_ += sizeof(T);
  }
  void put(const glm::dvec3& v) {
    for (int axis = 0; axis < 3; ++axis) put(static_cast<float>(v[axis]));
  }
  void putFace(const glm::uvec3& triangle) {
    put(std::uint8_t{3});
    for (int corner = 0; corner < 3; ++corner) put(std::uint32_t{triangle[corner]});
  }

 private:
  std::string& bytes_;
  char* at_;
};

std::string header(const TriangleMesh& mesh, const std::string& comments,
                   const std::string& ofVertices, const std::string& ofFaces) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  text.append(comments).append("element vertex ").append(std::to_string(mesh.vertices.size()));
  text.append("\nproperty float x\nproperty float y\nproperty float z\n").append(ofVertices);
  text.append("element face ").append(std::to_string(mesh.triangles.size()));
  text.append("\nproperty list uchar int vertex_indices\n").append(ofFaces);
  return text.append("end_header\n");
}

// A vertex's colour is that of the first face round it that is of the original surface; the
// inside's where there is none.
std::vector<glm::u8vec3> vertexColours(const PieceMesh& piece) {
  std::vector<glm::u8vec3> colours(piece.mesh.vertices.size(), kInsideColour);
  for (std::size_t t = piece.facing.size(); t-- > 0;) {
    if (piece.facing[t] != 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      colours[piece.mesh.triangles[t][static_cast<int>(k)]] = piece.look.colours[t][k];
    }
  }
  return colours;
}

std::string commentsOf(const PieceMesh& piece) {
  std::string text;
  const SurfaceLook& look = piece.look;
  for (std::size_t i = 0; i < piece.materials.materials.size() && !look.material.empty(); ++i) {
    const MaterialTable::Entry& material = piece.materials.materials[i];
    text.append("comment material ").append(std::to_string(i)).append(" ").append(material.name);
    if (material.texture >= 0) text.append(" ").append(std::to_string(material.texture));
    text.append("\n");
  }
  for (const MaterialTable::Picture& picture : piece.materials.textures) {
    if (look.texcoords.empty()) break;
    text.append("comment TextureFile ").append(picture.file).append("\n");
  }
  return text;
}

}  // namespace

void writePly(const OutputFile& file, const TriangleMesh& mesh,
              const std::vector<std::uint16_t>& facing) {
  assert(facing.empty() || facing.size() == mesh.triangles.size());
  if (!facing.empty()) {
    writePiecePly(file, {"", mesh, facing, {}, {}});
    return;
  }
  std::string bytes = header(mesh, "", "", "");
  {
    Records records(bytes, mesh.vertices.size() * 12 + mesh.triangles.size() * 13);
    for (const glm::dvec3& v : mesh.vertices) records.put(v);
    for (const glm::uvec3& t : mesh.triangles) records.putFace(t);
  }
  file.write(bytes);
}

void writePiecePly(const OutputFile& file, const PieceMesh& piece) {
  const TriangleMesh& mesh = piece.mesh;
  const SurfaceLook& look = piece.look;
  const bool colours = !look.colours.empty(), texcoords = !look.texcoords.empty();
  const bool materials = !look.material.empty();
  const bool textures = texcoords && piece.materials.textures.size() > 1;
  std::string ofVertices =
      "property float nx\nproperty float ny\nproperty float nz\nproperty int facing\n";
  if (colours) ofVertices += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  std::string ofFaces = "property int facing\n";
  if (texcoords) ofFaces += "property list uchar float texcoord\n";
  if (textures) ofFaces += "property int texnumber\n";
  if (materials) ofFaces += "property int material\n";
  std::string bytes = header(mesh, commentsOf(piece), ofVertices, ofFaces);

  const std::vector<glm::dvec3> normals = vertexNormals(mesh);
  const std::vector<std::uint16_t> facing = vertexFacing(mesh, piece.facing);
  const std::vector<glm::u8vec3> colour =
      colours ? vertexColours(piece) : std::vector<glm::u8vec3>();
  {
    Records records(bytes,
                    mesh.vertices.size() * 31 + mesh.triangles.size() * (texcoords ? 50 : 21));
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      records.put(mesh.vertices[i]);
      records.put(normals[i]);
      records.put(std::uint32_t{facing[i]});
      for (int k = 0; k < 3 && colours; ++k) records.put(std::uint8_t{colour[i][k]});
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      records.putFace(mesh.triangles[t]);
      records.put(std::uint32_t{piece.facing[t]});
      if (texcoords) records.put(std::uint8_t{6});
      for (std::size_t k = 0; k < 3 && texcoords; ++k) {
        records.put(look.texcoords[t][k].x);
        records.put(look.texcoords[t][k].y);
      }
      const int texture = materials ? piece.materials.materials[look.material[t]].texture : 0;
      if (textures) records.put(static_cast<std::uint32_t>(texture < 0 ? 0 : texture));
      if (materials) records.put(std::uint32_t{look.material[t]});
    }
  }
  file.write(bytes);
}

}  // namespace sherd
