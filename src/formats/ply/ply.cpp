// Writes meshes as binary little-endian PLY.
#include "formats/ply/ply.h"

#include <sherd/files.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <span>
#include <string>
#include <string_view>

#include "base/little_endian.h"
#include "formats/mesh/faces.h"
#include "formats/mesh/piece_mesh.h"

namespace sherd {
namespace {

// All records would take as much memory as the mesh, and more than the processor's cache, from
// which the sink reads a block.
constexpr std::size_t kBlock = std::size_t{64} << 10;

/// Writes a file's header and its records block by block.
class Records {
 public:
  /// Size of the longest record that has no polygon, bytes.
  static constexpr std::size_t kLargest = 64;

  ///   records  their number
  ///   largest  size of the longest, bytes
  Records(const ByteSink& sink, std::string_view header, std::size_t records,
          std::size_t largest = kLargest)
      : sink_(sink),
        largest_(largest),
        bytes_(std::min(records, kBlock / largest) * largest, '\0') {
    sink_(header);
  }

  /// To be called before each record.
  void begin() {
    if (bytes_.size() - end_ < largest_) finish();
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

 private:
  const ByteSink& sink_;
  std::size_t largest_;
  std::string bytes_;
  std::size_t end_ = 0;  // of the bytes in use
};

// Writes records of a fixed size block by block.
//   put  writes the record of an element to memory
template <std::size_t kSize, class Elements, class Put>
void writeRecords(const ByteSink& sink, const Elements& elements, const Put& put) {
  constexpr std::size_t kMost = kBlock / kSize;  // records of a block
  std::string block(std::min(elements.size(), kMost) * kSize, '\0');
  for (std::size_t first = 0; first < elements.size(); first += kMost) {
    const std::size_t end = std::min(elements.size(), first + kMost);
    char* at = block.data();
    for (std::size_t i = first; i < end; ++i, at += kSize) put(elements[i], at);
    sink(std::string_view(block).substr(0, (end - first) * kSize));
  }
}

template <class Number>
void writeVertices(const ByteSink& sink, const std::vector<glm::dvec3>& vertices) {
  writeRecords<3 * sizeof(Number)>(sink, vertices, [](const glm::dvec3& v, char* at) {
    keepLittle(at, static_cast<Number>(v.x));
    keepLittle(at + sizeof(Number), static_cast<Number>(v.y));
    keepLittle(at + 2 * sizeof(Number), static_cast<Number>(v.z));
  });
}

std::string header(const TriangleMesh& mesh, std::size_t faces, bool isDouble,
                   const std::string& comments, const std::string& ofVertices,
                   const std::string& ofFaces) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  text.append(comments).append("element vertex ").append(std::to_string(mesh.vertices.size()));
  for (const char* axis : {"x", "y", "z"})
    text.append("\nproperty ").append(isDouble ? "double " : "float ").append(axis);
  text.append("\n").append(ofVertices);
  text.append("element face ").append(std::to_string(faces));
  text.append("\nproperty list uchar int vertex_indices\n").append(ofFaces);
  return text.append("end_header\n");
}

// Returns for each vertex the color of the first face around it on the original surface; the
// inside's if there is none.
std::vector<glm::u8vec3> vertexColors(const PieceMesh& piece) {
  std::vector<glm::u8vec3> colors(piece.mesh.vertices.size(), kInsideColor);
  for (std::size_t t = piece.mesh.triangles.size(); t-- > 0;) {
    if (!piece.isOriginal(t)) continue;
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
  for (std::size_t i = 0; i < piece.materials.baseColorTextures(); ++i) {
    if (attributes.texcoords.empty()) break;
    text.append("comment TextureFile ").append(piece.materials.textures[i].file).append("\n");
  }
  return text;
}

// The faces of a piece with their attributes.
class FaceRecords {
 public:
  explicit FaceRecords(const PieceMesh& piece)
      : piece_(piece),
        hasTexcoords_(!piece.attributes.texcoords.empty()),
        hasTextures_(hasTexcoords_ && piece.materials.baseColorTextures() > 1),
        hasMaterials_(!piece.attributes.material.empty()),
        faces_(
            piece, [this](std::uint32_t a, std::uint32_t b) { return isSame(a, b); }, kMost) {}

  std::size_t count() const { return faces_.count(); }

  std::string properties() const {
    std::string text = "property int neighbor\n";
    if (hasTexcoords_) text += "property list uchar float texcoord\n";
    if (hasTextures_) text += "property int texnumber\n";
    if (hasMaterials_) text += "property int material\n";
    if (!piece_.sourceFaces.empty()) text += "property int source_face\n";
    return text;
  }

  // Returns the size of the longest record, bytes.
  std::size_t largest() const {
    constexpr std::size_t kPerCorner = sizeof(std::uint32_t) + sizeof(glm::vec2);
    return count() == piece_.mesh.triangles.size() ? Records::kLargest
                                                   : Records::kLargest + kMost * kPerCorner;
  }

  void put(Records& records) const {
    const SurfaceAttributes& attributes = piece_.attributes;
    std::array<std::uint32_t, 3> own{};
    for (std::uint32_t first = 0; first < piece_.mesh.triangles.size(); ++first) {
      const std::span<const std::uint32_t> corners = faces_.at(first, own);
      if (corners.empty()) continue;
      const std::uint32_t t = corners[0] / 3;
      records.begin();
      records.put(static_cast<std::uint8_t>(corners.size()));
      for (const std::uint32_t corner : corners) records.put(vertexOf(corner));
      records.put(std::uint32_t{piece_.mesh.neighborOf(t)});
      if (hasTexcoords_) records.put(static_cast<std::uint8_t>(2 * corners.size()));
      for (std::size_t k = 0; k < corners.size() && hasTexcoords_; ++k) {
        const glm::vec2& at = attributes.texcoords[corners[k] / 3][corners[k] % 3];
        records.put(at.x);
        records.put(at.y);
      }
      if (hasMaterials_) putMaterial(records, attributes.material[t]);
      if (!piece_.sourceFaces.empty())
        records.put(static_cast<std::uint32_t>(piece_.sourceFaces[t]));
    }
  }

 private:
  // Two numbers of texture coordinates for each corner, and a byte counts these.
  static constexpr std::size_t kMost = 127;

  void putMaterial(Records& records, std::uint32_t material) const {
    const int texture = piece_.materials.materials[material].texture;
    if (hasTextures_) records.put(static_cast<std::uint32_t>(texture < 0 ? 0 : texture));
    records.put(material);
  }

  std::uint32_t vertexOf(std::uint32_t corner) const {
    return piece_.mesh.triangles[corner / 3][static_cast<int>(corner % 3)];
  }

  bool isSame(std::uint32_t a, std::uint32_t b) const {
    const SurfaceAttributes& attributes = piece_.attributes;
    return vertexOf(a) == vertexOf(b) &&
           (!hasTexcoords_ ||
            attributes.texcoords[a / 3][a % 3] == attributes.texcoords[b / 3][b % 3]) &&
           (!hasMaterials_ || attributes.material[a / 3] == attributes.material[b / 3]);
  }

  const PieceMesh& piece_;
  bool hasTexcoords_, hasTextures_, hasMaterials_;
  Faces faces_;  // last: it compares corners by the others
};

}  // namespace

void writePly(const OutputFile& file, const TriangleMesh& mesh) {
  assert(mesh.neighbor.empty() || mesh.neighbor.size() == mesh.triangles.size());
  if (mesh.neighbor.empty()) return writePlainPly(file, mesh);
  writePiecePly(file, {"", mesh, {}, {}});
}

void writePlainPly(const OutputFile& file, const TriangleMesh& mesh, bool isDouble) {
  file.write([&](const ByteSink& sink) {
    sink(header(mesh, mesh.triangles.size(), isDouble, "", "", ""));
    isDouble ? writeVertices<double>(sink, mesh.vertices)
             : writeVertices<float>(sink, mesh.vertices);
    writeRecords<13>(sink, mesh.triangles, [](const glm::uvec3& t, char* at) {
      at[0] = 3;
      keepLittle(at + 1, std::uint32_t{t.x});
      keepLittle(at + 5, std::uint32_t{t.y});
      keepLittle(at + 9, std::uint32_t{t.z});
    });
  });
}

void writePiecePly(const OutputFile& file, const PieceMesh& piece) {
  const TriangleMesh& mesh = piece.mesh;
  const SurfaceAttributes& attributes = piece.attributes;
  const bool colors = !attributes.colors.empty();
  std::string ofVertices =
      "property float nx\nproperty float ny\nproperty float nz\nproperty int neighbor\n";
  if (colors) ofVertices += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const FaceRecords faceRecords(piece);
  const std::vector<glm::dvec3> normals = meanNormals(piece);
  const std::vector<std::uint16_t> neighbor = vertexNeighbor(mesh);
  const std::vector<glm::u8vec3> color = colors ? vertexColors(piece) : std::vector<glm::u8vec3>();
  file.write([&](const ByteSink& sink) {
    const std::size_t faces = faceRecords.count();
    Records records(sink,
                    header(mesh, faces, piece.isDouble, commentsOf(piece), ofVertices,
                           faceRecords.properties()),
                    mesh.vertices.size() + faces, faceRecords.largest());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      records.begin();
      records.put(mesh.vertices[i], piece.isDouble);
      records.put(normals[i]);
      records.put(std::uint32_t{neighbor[i]});
      for (int k = 0; k < 3 && colors; ++k) records.put(std::uint8_t{color[i][k]});
    }
    faceRecords.put(records);
    records.finish();
  });
}

}  // namespace sherd
