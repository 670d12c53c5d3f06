// The meshes of the viewer's page as bytes.
#include "viewer/encode.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/type_precision.hpp>
#include <numeric>
#include <tuple>

#include "base/little_endian.h"
#include "formats/mesh/piece_mesh.h"

namespace sherd {
namespace {

constexpr double kMost = 65535.0;  // of 16 bits

void putSigned(std::string& bytes, double value) {
  storeLittle(bytes, static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(value))));
}

// A unit vector on the octahedron, unfolded to a square: two numbers in -1..1.
//   source  Z. Cigolle et al., Survey of Efficient Representations for Unit Vectors, 2014
glm::dvec2 octahedral(const glm::dvec3& n) {
  const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (sum == 0.0) return glm::dvec2(0.0);
  const glm::dvec2 p(n.x / sum, n.y / sum);
  if (n.z >= 0.0) return p;
  return {(1.0 - std::abs(p.y)) * (p.x >= 0.0 ? 1.0 : -1.0),
          (1.0 - std::abs(p.x)) * (p.y >= 0.0 ? 1.0 : -1.0)};
}

// The material of each triangle; of faces without one that of their side.
std::vector<int> materialsOf(const TriangleMesh& mesh, const SurfaceAttributes& attributes,
                             const std::vector<ViewerScene::Material>& materials) {
  int outside = -1, inside = -1;
  for (std::size_t i = materials.size(); i-- > 0;) {
    (materials[i].isInside ? inside : outside) = static_cast<int>(i);
  }
  std::vector<int> result(mesh.triangles.size(), outside);
  for (std::size_t t = 0; t < result.size(); ++t) {
    if (mesh.neighborOf(t) != 0) result[t] = inside;
    if (attributes.material.empty()) continue;
    const std::size_t own = attributes.material[t];
    result[t] = own < materials.size() ? static_cast<int>(own) : -1;
  }
  return result;
}

// An edge of a triangle, from the lower vertex.
struct Side {
  std::uint32_t low = 0, high = 0;  // vertices of the mesh
  std::uint32_t lowCorner = 0, highCorner = 0;
  std::uint16_t neighbor = 0;

  bool operator<(const Side& other) const {
    return std::tie(low, high, neighbor, lowCorner, highCorner) <
           std::tie(other.low, other.high, other.neighbor, other.lowCorner, other.highCorner);
  }
};

// Pairs of corners: edges where faces of different neighbors meet.
std::vector<glm::uvec2> linesOf(const TriangleMesh& mesh, const SplitCorners& split) {
  std::vector<Side> sides;
  if (mesh.neighbor.empty()) return {};
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = split.ofTriangle[t][k], b = split.ofTriangle[t][(k + 1) % 3];
      Side side{split.corners[a].vertex, split.corners[b].vertex, a, b, mesh.neighbor[t]};
      if (side.low > side.high) {
        std::swap(side.low, side.high);
        std::swap(side.lowCorner, side.highCorner);
      }
      sides.push_back(side);
    }
  }
  std::sort(sides.begin(), sides.end());
  std::vector<glm::uvec2> lines;
  for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
    while (end < sides.size() && sides[end].low == sides[first].low &&
           sides[end].high == sides[first].high) {
      ++end;
    }
    if (sides[end - 1].neighbor == sides[first].neighbor) continue;
    lines.emplace_back(sides[end - 1].lowCorner, sides[end - 1].highCorner);
  }
  return lines;
}

// Which triangles are kept, those of one neighbor and material together.
std::vector<std::size_t> orderOf(const TriangleMesh& mesh, const std::vector<int>& material,
                                 const std::vector<glm::u16vec3>& on) {
  std::vector<std::size_t> order;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& corner = mesh.triangles[t];
    const glm::u16vec3 a = on[corner.x], b = on[corner.y], c = on[corner.z];
    if (a != b && b != c && c != a) order.push_back(t);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(mesh.neighborOf(a), material[a]) < std::pair(mesh.neighborOf(b), material[b]);
  });
  return order;
}

void putCorners(std::string& bytes, const SplitCorners& split, const std::vector<glm::u16vec3>& on,
                const ViewerArrays& arrays, const TexcoordGrid& texcoords) {
  for (const SplitCorners::Corner& corner : split.corners) {
    for (int axis = 0; axis < 3; ++axis) storeLittle(bytes, on[corner.vertex][axis]);
  }
  for (const SplitCorners::Corner& corner : split.corners) {
    const glm::dvec2 normal = octahedral(split.normals[corner.normal]);
    putSigned(bytes, normal.x * 32767.0);
    putSigned(bytes, normal.y * 32767.0);
  }
  for (std::size_t i = 0; arrays.texcoords && i < split.corners.size(); ++i) {
    const glm::u16vec2 texcoord = texcoords.of(split.corners[i].texcoord);
    storeLittle(bytes, texcoord.x);
    storeLittle(bytes, texcoord.y);
  }
  for (std::size_t i = 0; arrays.colors && i < split.corners.size(); ++i) {
    for (int k = 0; k < 3; ++k) storeLittle(bytes, split.corners[i].color[k]);
  }
}

}  // namespace

PositionGrid::PositionGrid(const Box& box) : low(box.min), step(longestSide(box) / kMost) {
  if (!(step > 0.0)) step = 1.0;
}

glm::u16vec3 PositionGrid::of(const glm::dvec3& position) const {
  return glm::u16vec3(glm::clamp(glm::round((position - low) / step), 0.0, kMost));
}

TexcoordGrid::TexcoordGrid(const ViewerScene& scene) {
  glm::vec2 high(0.0f);
  bool isFirst = true;
  for (const ViewerPiece& piece : scene.pieces) {
    if (piece.attributes == nullptr) continue;
    for (const std::array<glm::vec2, 3>& corners : piece.attributes->texcoords) {
      for (const glm::vec2& corner : corners) {
        low = isFirst ? corner : glm::min(low, corner);
        high = isFirst ? corner : glm::max(high, corner);
        isFirst = false;
      }
    }
  }
  step = glm::max((high - low) / static_cast<float>(kMost), glm::vec2(1e-12f));
}

glm::u16vec2 TexcoordGrid::of(const glm::vec2& texcoord) const {
  return glm::u16vec2(
      glm::clamp(glm::round((texcoord - low) / step), 0.0f, static_cast<float>(kMost)));
}

ViewerArrays::ViewerArrays(const ViewerScene& scene) {
  for (const ViewerPiece& piece : scene.pieces) {
    if (piece.attributes == nullptr) continue;
    colors |= !piece.attributes->colors.empty();
    texcoords |= !piece.attributes->texcoords.empty() && !scene.textures.empty();
  }
}

EncodedMesh encodedMesh(const TriangleMesh& mesh, const SurfaceAttributes& attributes,
                        const std::vector<ViewerScene::Material>& materials,
                        const ViewerArrays& arrays, const PositionGrid& positions,
                        const TexcoordGrid& texcoords) {
  static const std::string kNoName;
  static const MaterialTable kNoMaterials;
  SplitCorners split = splitCorners({kNoName, mesh, attributes, kNoMaterials});
  if (attributes.colors.empty()) {  // of a mesh beside others that have colors
    for (SplitCorners::Corner& corner : split.corners) corner.color = glm::u8vec3(255);
  }
  std::vector<glm::u16vec3> on(mesh.vertices.size());
  std::ranges::transform(mesh.vertices, on.begin(),
                         [&](const glm::dvec3& vertex) { return positions.of(vertex); });
  const std::vector<int> material = materialsOf(mesh, attributes, materials);
  const std::vector<std::size_t> order = orderOf(mesh, material, on);
  const std::vector<glm::uvec2> lines = linesOf(mesh, split);
  EncodedMesh encoded{
      .vertices = split.corners.size(), .triangles = order.size(), .lines = lines.size()};
  putCorners(encoded.bytes, split, on, arrays, texcoords);
  const auto putIndex = [&](std::uint32_t index) {
    if (encoded.vertices > 65536) {
      storeLittle(encoded.bytes, index);
    } else {
      storeLittle(encoded.bytes, static_cast<std::uint16_t>(index));
    }
  };
  for (const std::size_t t : order) {
    const std::uint16_t neighbor = mesh.neighborOf(t);
    if (encoded.runs.empty() || encoded.runs.back().neighbor != neighbor ||
        encoded.runs.back().material != material[t]) {
      encoded.runs.push_back({neighbor, material[t], 0});
    }
    ++encoded.runs.back().triangles;
    for (const std::uint32_t corner : split.ofTriangle[t]) putIndex(corner);
  }
  for (const glm::uvec2& line : lines) {
    putIndex(line.x);
    putIndex(line.y);
  }
  return encoded;
}

}  // namespace sherd
