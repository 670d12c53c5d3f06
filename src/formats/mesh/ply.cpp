// Writes meshes as binary little-endian PLY.
#include <sherd/files.h>

#include <algorithm>
#include <cassert>
#include <string>
#include <string_view>

#include "base/little_endian.h"
#include "formats/mesh/piece_mesh.h"

namespace sherd {
namespace {

/// Writes a file's header and its records block by block: all of them would take as much memory as
/// the mesh.
class Records {
 public:
  /// Largest size of a record, bytes.
  static constexpr std::size_t kLargest = 64;

  ///   records  their number
  Records(const ByteSink& sink, std::string_view header, std::size_t records)
      : sink_(sink), bytes_(std::min(records, kBlock / kLargest) * kLargest, '\0') {
    sink_(header);
  }

  /// To be called before each record.
  void begin() {
    if (bytes_.size() - end_ < kLargest) finish();
  }
  void finish() {
    if (end_ > 0) sink_(std::string_view(bytes_).substr(0, end_));
    end_ = 0;
  }

  template <class T>
  void put(T value) {
    keepLittle(bytes_.data() + end_, value);
    end_ += sizeof(T);
  }
  void put(const glm::dvec3& v, bool isDouble = false) {
    for (int axis = 0; axis < 3; ++axis) {
      if (isDouble) {
        put(v[axis]);
      } else {
        put(static_cast<float>(v[axis]));
      }
    }
  }
  void putFace(const glm::uvec3& triangle) {
    put(std::uint8_t{3});
    for (int corner = 0; corner < 3; ++corner) put(std::uint32_t{triangle[corner]});
  }

 private:
  static constexpr std::size_t kBlock = std::size_t{4} << 20;

  const ByteSink& sink_;
  std::string bytes_;
  std::size_t end_ = 0;  // of the bytes in use
};

std::string header(const TriangleMesh& mesh, bool isDouble, const std::string& comments,
                   const std::string& ofVertices, const std::string& ofFaces) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  text.append(comments).append("element vertex ").append(std::to_string(mesh.vertices.size()));
  for (const char* axis : {"x", "y", "z"})
    text.append("\nproperty ").append(isDouble ? "double " : "float ").append(axis);
  text.append("\n").append(ofVertices);
  text.append("element face ").append(std::to_string(mesh.triangles.size()));
  text.append("\nproperty list uchar int vertex_indices\n").append(ofFaces);
  return text.append("end_header\n");
}

// Returns for each vertex the color of the first face around it on the original surface; the
// inside's if there is none.
std::vector<glm::u8vec3> vertexColors(const PieceMesh& piece) {
  std::vector<glm::u8vec3> colors(piece.mesh.vertices.size(), kInsideColor);
  for (std::size_t t = piece.mesh.triangles.size(); t-- > 0;) {
    if (piece.mesh.neighborOf(t) != 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      colors[piece.mesh.triangles[t][static_cast<int>(k)]] = piece.attributes.colors[t][k];
    }
  }
  return colors;
}

std::string commentsOf(const PieceMesh& piece) {
  std::string text;
  const SurfaceAttributes& attributes = piece.attributes;
  for (std::size_t i = 0; i < piece.materials.materials.size() && !attributes.material.empty();
       ++i) {
    const MaterialTable::Entry& material = piece.materials.materials[i];
    text.append("comment material ").append(std::to_string(i)).append(" ").append(material.name);
    if (material.texture >= 0) text.append(" ").append(std::to_string(material.texture));
    text.append("\n");
  }
  for (const MaterialTable::Image& image : piece.materials.textures) {
    if (attributes.texcoords.empty()) break;
    text.append("comment TextureFile ").append(image.file).append("\n");
  }
  return text;
}

}  // namespace

void writePly(const OutputFile& file, const TriangleMesh& mesh) {
  assert(mesh.neighbor.empty() || mesh.neighbor.size() == mesh.triangles.size());
  if (mesh.neighbor.empty()) return writePlainPly(file, mesh);
  writePiecePly(file, {"", mesh, {}, {}});
}

void writePlainPly(const OutputFile& file, const TriangleMesh& mesh, bool isDouble) {
  file.write([&](const ByteSink& sink) {
    Records records(sink, header(mesh, isDouble, "", "", ""),
                    mesh.vertices.size() + mesh.triangles.size());
    for (const glm::dvec3& v : mesh.vertices) {
      records.begin();
      records.put(v, isDouble);
    }
    for (const glm::uvec3& t : mesh.triangles) {
      records.begin();
      records.putFace(t);
    }
    records.finish();
  });
}

void writePiecePly(const OutputFile& file, const PieceMesh& piece) {
  const TriangleMesh& mesh = piece.mesh;
  const SurfaceAttributes& attributes = piece.attributes;
  const bool colors = !attributes.colors.empty(), texcoords = !attributes.texcoords.empty();
  const bool materials = !attributes.material.empty();
  const bool textures = texcoords && piece.materials.textures.size() > 1;
  std::string ofVertices =
      "property float nx\nproperty float ny\nproperty float nz\nproperty int neighbor\n";
  if (colors) ofVertices += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  std::string ofFaces = "property int neighbor\n";
  if (texcoords) ofFaces += "property list uchar float texcoord\n";
  if (textures) ofFaces += "property int texnumber\n";
  if (materials) ofFaces += "property int material\n";

  const std::vector<glm::dvec3> normals = meanNormals(piece);
  const std::vector<std::uint16_t> neighbor = vertexNeighbor(mesh);
  const std::vector<glm::u8vec3> color = colors ? vertexColors(piece) : std::vector<glm::u8vec3>();
  file.write([&](const ByteSink& sink) {
    Records records(sink, header(mesh, piece.isDouble, commentsOf(piece), ofVertices, ofFaces),
                    mesh.vertices.size() + mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      records.begin();
      records.put(mesh.vertices[i], piece.isDouble);
      records.put(normals[i]);
      records.put(std::uint32_t{neighbor[i]});
      for (int k = 0; k < 3 && colors; ++k) records.put(std::uint8_t{color[i][k]});
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      records.begin();
      records.putFace(mesh.triangles[t]);
      records.put(std::uint32_t{mesh.neighborOf(t)});
      if (texcoords) records.put(std::uint8_t{6});
      for (std::size_t k = 0; k < 3 && texcoords; ++k) {
        records.put(attributes.texcoords[t][k].x);
        records.put(attributes.texcoords[t][k].y);
      }
      const int texture = materials ? piece.materials.materials[attributes.material[t]].texture : 0;
      if (textures) records.put(static_cast<std::uint32_t>(texture < 0 ? 0 : texture));
      if (materials) records.put(std::uint32_t{attributes.material[t]});
    }
    records.finish();
  });
}

}  // namespace sherd
