// Writes meshes as OBJ.
#include "formats/obj/obj.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>

#include "base/text/number_text.h"
#include "formats/mesh/faces.h"
#include "formats/mesh/piece_mesh.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNoGroup = 0xffffffffu;

// Returns for each triangle the index of its group in the input, kNoGroup on cracks; nothing if the
// input has one object.
std::vector<std::uint32_t> groupsOf(const PieceMesh& piece) {
  std::vector<std::uint32_t> groups;
  if (piece.input == nullptr || piece.input->groups.empty() || piece.mesh.source.empty())
    return groups;
  for (const std::uint32_t source : piece.mesh.source) {
    groups.push_back(source == TriangleMesh::kNoSource
                         ? kNoGroup
                         : piece.input->source.objectOfTriangle[source]);
  }
  return groups;
}

// Appends the faces, those of one material and group together.
//   texcoordOf      [split.corners] number in the file, 0: none
//   namesMaterials  whether the file has a library
void appendFaces(std::string& text, const PieceMesh& piece, const SplitCorners& split,
                 const std::vector<std::size_t>& texcoordOf, bool namesMaterials) {
  const auto splitCorner = [&](std::uint32_t corner) {
    return split.ofTriangle[corner / 3][corner % 3];
  };
  const Faces faces(piece, [&](std::uint32_t a, std::uint32_t b) {
    return splitCorner(a) == splitCorner(b) && piece.materialOf(a / 3) == piece.materialOf(b / 3);
  });
  const std::vector<std::uint32_t> groups = groupsOf(piece);
  const auto under = [&](std::uint32_t t) {
    return std::pair(piece.materialOf(t), groups.empty() ? kNoGroup : groups[t]);
  };
  std::vector<std::uint32_t> order(piece.mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return under(a) < under(b); });
  std::array<std::uint32_t, 3> own{};
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto [material, group] = under(order[i]);
    const bool isFirst = i == 0 || under(order[i - 1]) != under(order[i]);
    if (isFirst && namesMaterials && (i == 0 || under(order[i - 1]).first != material)) {
      text += "usemtl " + piece.materials.materials[material].name + "\n";
    }
    if (isFirst && !groups.empty()) {
      text.append("g ").append(group == kNoGroup ? kInsideGroup : piece.input->groups[group]);
      text += '\n';
    }
    const std::span<const std::uint32_t> corners = faces.at(order[i], own);
    if (corners.empty()) continue;
    text += 'f';
    for (const std::uint32_t at : corners) {
      const std::uint32_t number = splitCorner(at);
      appendShortest(text += ' ', split.corners[number].vertex + 1);
      text += '/';
      if (texcoordOf[number] > 0) appendShortest(text, texcoordOf[number]);
      appendShortest(text += '/', split.corners[number].normal + 1);
    }
    text += '\n';
  }
}

}  // namespace

void writePieceObj(const OutputFile& file, const PieceMesh& piece, const std::string& library) {
  const TriangleMesh& mesh = piece.mesh;
  const SplitCorners split = splitCorners(piece);
  const bool colors = !piece.attributes.colors.empty(),
             texcoords = !piece.attributes.texcoords.empty();
  std::string text = library.empty() ? "" : "mtllib " + library + "\n";
  text += "o " + piece.name + "\n";
  text.reserve(mesh.vertices.size() * ((colors ? 60 : 36) + (piece.isDouble ? 24 : 0)) +
               split.normals.size() * 36 + split.corners.size() * (texcoords ? 24 : 0) +
               mesh.triangles.size() * 54);

  // The format has one color per vertex: the original surface's precedes the inside's.
  std::vector<glm::u8vec3> color(colors ? mesh.vertices.size() : 0, kInsideColor);
  for (std::size_t i = split.corners.size(); i-- > 0 && colors;) {
    const SplitCorners::Corner& corner = split.corners[i];
    if (corner.neighbor == 0) color[corner.vertex] = corner.color;
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    appendVector(text += 'v', mesh.vertices[i], piece.isDouble);
    for (int k = 0; k < 3 && colors; ++k) {
      appendFloat(text += ' ', static_cast<float>(color[i][k]) / 255.0f);
    }
    text += '\n';
  }
  for (const glm::dvec3& normal : split.normals) {
    appendVector(text += "vn", normal);
    text += '\n';
  }
  std::vector<std::size_t> texcoordOf(split.corners.size(), 0);  // from 1; 0: none
  std::size_t count = 0;
  for (std::size_t i = 0; i < split.corners.size() && texcoords; ++i) {
    if (split.corners[i].neighbor != 0) continue;
    texcoordOf[i] = ++count;
    appendFloat(text += "vt ", split.corners[i].texcoord.x);
    appendFloat(text += ' ', split.corners[i].texcoord.y);
    text += '\n';
  }

  appendFaces(text, piece, split, texcoordOf, !library.empty());
  file.write(text);
}

void writePlainObj(const OutputFile& file, const TriangleMesh& mesh, bool isDouble) {
  std::string text;
  text.reserve(mesh.vertices.size() * (isDouble ? 60 : 36) + mesh.triangles.size() * 24);
  for (const glm::dvec3& vertex : mesh.vertices) {
    appendVector(text += 'v', vertex, isDouble);
    text += '\n';
  }
  for (const glm::uvec3& t : mesh.triangles) {
    text += 'f';
    for (int k = 0; k < 3; ++k) appendShortest(text += ' ', t[k] + 1);
    text += '\n';
  }
  file.write(text);
}

}  // namespace sherd
