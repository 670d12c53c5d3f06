// A fragment's mesh as its files hold it.
#include "formats/mesh/piece_mesh.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "mesh/vertex_normals.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Things that belong to vertices, in a chain for each vertex: most have one or two.
class Chains {
 public:
  explicit Chains(std::size_t vertices) : first_(vertices, kNone) {}

  // The thing at the vertex for which `is` holds; a new number where there is none.
  template <class Is>
  std::uint32_t find(std::uint32_t vertex, Is&& is) {
    std::uint32_t* at = &first_[vertex];
    while (*at != kNone && !is(*at)) at = &next_[*at];
    if (*at != kNone) return *at;
    const auto fresh = static_cast<std::uint32_t>(next_.size());
    *at = fresh;  // before next_ may move
    next_.push_back(kNone);
    return fresh;
  }

 private:
  std::vector<std::uint32_t> first_, next_;
};

// Sums of angles that differ by less are equal: each is told to 4e-8.
constexpr double kSameAngle = 1e-6;

}  // namespace

std::vector<std::uint16_t> vertexFacing(const TriangleMesh& mesh,
                                        const std::vector<std::uint16_t>& facing) {
  std::vector<std::uint16_t> out(mesh.vertices.size(), 0);
  std::vector<std::uint8_t> several(mesh.vertices.size(), 0);  // where angles decide
  for (std::size_t t = 0; t < facing.size(); ++t) {
    for (int k = 0; k < 3 && facing[t] != 0; ++k) {
      const std::uint32_t vertex = mesh.triangles[t][k];
      if (out[vertex] != 0 && out[vertex] != facing[t]) several[vertex] = 1;
      out[vertex] = facing[t];
    }
  }
  struct Share {
    std::uint32_t vertex;
    std::uint16_t facing;
    double angle;
  };
  std::vector<Share> shares;
  for (std::size_t t = 0; t < facing.size(); ++t) {
    const glm::uvec3& corners = mesh.triangles[t];
    if (facing[t] == 0 || !(several[corners.x] | several[corners.y] | several[corners.z])) continue;
    const Corners at = cornersOf(mesh, corners);
    for (int k = 0; k < 3; ++k) {
      if (several[corners[k]]) {
        shares.push_back({corners[k], facing[t], at.angle[static_cast<std::size_t>(k)]});
      }
    }
  }
  std::stable_sort(shares.begin(), shares.end(), [](const Share& a, const Share& b) {
    return std::tie(a.vertex, a.facing) < std::tie(b.vertex, b.facing);
  });
  double most = -1.0;
  for (std::size_t i = 0; i < shares.size();) {
    const Share& share = shares[i];
    if (i == 0 || shares[i - 1].vertex != share.vertex) most = -1.0;
    double sum = 0.0;
    for (;
         i < shares.size() && shares[i].vertex == share.vertex && shares[i].facing == share.facing;
         ++i) {
      sum += shares[i].angle;
    }
    if (sum > most + kSameAngle) {
      most = sum;
      out[share.vertex] = share.facing;
    }
  }
  return out;
}

SplitCorners splitCorners(const PieceMesh& piece) {
  const TriangleMesh& mesh = piece.mesh;
  SplitCorners split;
  split.ofTriangle.resize(mesh.triangles.size());
  Chains normalsOf(mesh.vertices.size()), cornersAt(mesh.vertices.size());
  std::vector<std::uint16_t> facingOfNormal;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners at = cornersOf(mesh, mesh.triangles[t]);
    for (std::size_t k = 0; k < 3; ++k) {
      SplitCorners::Corner corner;
      corner.vertex = mesh.triangles[t][static_cast<int>(k)];
      corner.facing = piece.facing[t];
      corner.normal = normalsOf.find(
          corner.vertex, [&](std::uint32_t i) { return facingOfNormal[i] == corner.facing; });
      if (corner.normal == split.normals.size()) {
        split.normals.emplace_back(0.0);
        facingOfNormal.push_back(corner.facing);
      }
      split.normals[corner.normal] += at.angle[k] * at.normal;
      if (!piece.look.texcoords.empty()) corner.texcoord = piece.look.texcoords[t][k];
      if (!piece.look.colours.empty()) corner.colour = piece.look.colours[t][k];
      const std::uint32_t number = cornersAt.find(
          corner.vertex, [&](std::uint32_t i) { return split.corners[i] == corner; });
      if (number == split.corners.size()) split.corners.push_back(corner);
      split.ofTriangle[t][k] = number;
    }
  }
  for (glm::dvec3& normal : split.normals) {
    normal = unitOrZero(normal);
    if (normal == glm::dvec3(0.0)) normal.y = 1.0;  // formats want a unit vector
  }
  return split;
}

void writePiece(const OutputFile& file, MeshFileFormat format, const PieceMesh& piece,
                const std::string& library) {
  switch (format) {
    case MeshFileFormat::ply:
      return writePiecePly(file, piece);
    case MeshFileFormat::obj:
      return writePieceObj(file, piece, library);
    case MeshFileFormat::glb:
      return writePieceGlb(file, piece);
    case MeshFileFormat::stl:
      return writePieceStl(file, piece);
    case MeshFileFormat::stlText:
      return writePieceStlText(file, piece);
    case MeshFileFormat::binm:
      return writePieceBinm(file, piece);
  }
}

}  // namespace sherd
