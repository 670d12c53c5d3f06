// A fragment's mesh as it is written to files.
#include "formats/mesh/piece_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "formats/mesh/creases.h"
#include "mesh/vertex_normals.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Numbered items of vertices, a linked list for each vertex: most have one or two.
class Chains {
 public:
  explicit Chains(std::size_t vertices) : first_(vertices, kNone) {}

  // Returns the item of the vertex for which `matches` holds; a new number if there is none.
  template <class Predicate>
  std::uint32_t find(std::uint32_t vertex, Predicate&& matches) {
    std::uint32_t* at = &first_[vertex];
    while (*at != kNone && !matches(*at)) at = &next_[*at];
    if (*at != kNone) return *at;
    const auto fresh = static_cast<std::uint32_t>(next_.size());
    *at = fresh;  // before next_ reallocates
    next_.push_back(kNone);
    return fresh;
  }

 private:
  std::vector<std::uint32_t> first_, next_;
};

// Numbers the normals of corners: those of the input, and means over groups of corners.
class NormalNumbers {
 public:
  //   normals  set by numberOf() and finish()
  NormalNumbers(const PieceMesh& piece, std::vector<glm::dvec3>& normals)
      : piece_(piece), normals_(normals), chains_(piece.mesh.vertices.size()) {
    // Triangles of a voxel's size round the creases of a smooth surface, other than those of
    // cracks.  Others differ in size, and a small one beside a plane must not tilt its normals.
    if (!piece.mesh.source.empty() || piece.mesh.isMerged) groups_ = creaseGroups(piece.mesh);
  }

  // Returns the number of the normal of corner k of triangle t, whose corners are `at`.
  std::uint32_t numberOf(std::size_t t, std::size_t k, const Corners& at) {
    const glm::dvec3 given(piece_.normalOf(t, k));
    const bool isGiven = given != glm::dvec3(0.0);
    const std::uint32_t computed =
        groups_.empty() ? std::uint32_t{piece_.mesh.neighborOf(t)} : groups_[3 * t + k];
    const std::uint32_t group = isGiven ? kNone : computed;
    const std::uint32_t vertex = piece_.mesh.triangles[t][static_cast<int>(k)];
    const std::uint32_t number = chains_.find(vertex, [&](std::uint32_t i) {
      return groupOf_[i] == group && (!isGiven || normals_[i] == given);
    });
    if (number == normals_.size()) {
      normals_.push_back(given);
      groupOf_.push_back(group);
    }
    if (!isGiven)
      normals_[number] += (groups_.empty() ? 1.0 : at.twiceArea) * at.angle[k] * at.normal;
    return number;
  }

  // Makes the means unit vectors.
  void finish() {
    for (std::size_t i = 0; i < normals_.size(); ++i) {
      if (groupOf_[i] == kNone) continue;
      normals_[i] = unitOrZero(normals_[i]);
      if (normals_[i] == glm::dvec3(0.0)) normals_[i].y = 1.0;  // formats require a unit vector
    }
  }

 private:
  const PieceMesh& piece_;
  std::vector<glm::dvec3>& normals_;
  Chains chains_;
  std::vector<std::uint32_t> groups_;   // of corners, or empty
  std::vector<std::uint32_t> groupOf_;  // [normals_] kNone: of the input
};

// Sums of angles that differ by less are equal: an angle is exact to 4e-8.
constexpr double kSameAngle = 1e-6;

}  // namespace

std::vector<std::uint16_t> vertexNeighbor(const TriangleMesh& mesh) {
  const std::vector<std::uint16_t>& neighbor = mesh.neighbor;
  std::vector<std::uint16_t> out(mesh.vertices.size(), 0);
  std::vector<std::uint8_t> several(mesh.vertices.size(), 0);  // where angles decide
  for (std::size_t t = 0; t < neighbor.size(); ++t) {
    for (int k = 0; k < 3 && neighbor[t] != 0; ++k) {
      const std::uint32_t vertex = mesh.triangles[t][k];
      if (out[vertex] != 0 && out[vertex] != neighbor[t]) several[vertex] = 1;
      out[vertex] = neighbor[t];
    }
  }
  struct Share {
    std::uint32_t vertex;
    std::uint16_t neighbor;
    double angle;
  };
  std::vector<Share> shares;
  for (std::size_t t = 0; t < neighbor.size(); ++t) {
    const glm::uvec3& corners = mesh.triangles[t];
    if (neighbor[t] == 0 || !(several[corners.x] | several[corners.y] | several[corners.z]))
      continue;
    const Corners at = cornersOf(mesh, corners);
    for (int k = 0; k < 3; ++k) {
      if (several[corners[k]]) {
        shares.push_back({corners[k], neighbor[t], at.angle[static_cast<std::size_t>(k)]});
      }
    }
  }
  std::stable_sort(shares.begin(), shares.end(), [](const Share& a, const Share& b) {
    return std::tie(a.vertex, a.neighbor) < std::tie(b.vertex, b.neighbor);
  });
  double most = -1.0;
  for (std::size_t i = 0; i < shares.size();) {
    const Share& share = shares[i];
    if (i == 0 || shares[i - 1].vertex != share.vertex) most = -1.0;
    double sum = 0.0;
    for (; i < shares.size() && shares[i].vertex == share.vertex &&
           shares[i].neighbor == share.neighbor;
         ++i) {
      sum += shares[i].angle;
    }
    if (sum > most + kSameAngle) {
      most = sum;
      out[share.vertex] = share.neighbor;
    }
  }
  return out;
}

std::vector<glm::dvec3> meanNormals(const PieceMesh& piece) {
  const TriangleMesh& mesh = piece.mesh;
  if (piece.attributes.normals.empty()) return vertexNormals(mesh);
  std::vector<glm::dvec3> sums(mesh.vertices.size(), glm::dvec3(0.0)), firsts = sums;
  std::vector<std::uint8_t> differ(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners at = cornersOf(mesh, mesh.triangles[t]);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.triangles[t][static_cast<int>(k)];
      glm::dvec3 normal(piece.normalOf(t, k));
      if (normal == glm::dvec3(0.0)) normal = at.normal;
      sums[vertex] += at.angle[k] * normal;
      if (firsts[vertex] == glm::dvec3(0.0)) firsts[vertex] = normal;
      if (firsts[vertex] != normal) differ[vertex] = 1;
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i] = differ[i] != 0 ? unitOrZero(sums[i]) : firsts[i];
  }
  return sums;
}

SplitCorners splitCorners(const PieceMesh& piece) {
  const TriangleMesh& mesh = piece.mesh;
  SplitCorners split;
  split.ofTriangle.resize(mesh.triangles.size());
  Chains cornersAt(mesh.vertices.size());
  NormalNumbers normals(piece, split.normals);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners at = cornersOf(mesh, mesh.triangles[t]);
    for (std::size_t k = 0; k < 3; ++k) {
      SplitCorners::Corner corner;
      corner.vertex = mesh.triangles[t][static_cast<int>(k)];
      corner.neighbor = mesh.neighborOf(t);
      corner.normal = normals.numberOf(t, k, at);
      if (!piece.attributes.texcoords.empty()) corner.texcoord = piece.attributes.texcoords[t][k];
      if (!piece.attributes.colors.empty()) corner.color = piece.attributes.colors[t][k];
      const std::uint32_t number = cornersAt.find(
          corner.vertex, [&](std::uint32_t i) { return split.corners[i] == corner; });
      if (number == split.corners.size()) split.corners.push_back(corner);
      split.ofTriangle[t][k] = number;
    }
  }
  normals.finish();
  return split;
}

std::vector<std::array<glm::vec3, 3>> shortNormals(const PieceMesh& piece) {
  const SplitCorners split = splitCorners(piece);
  const auto rounded = [](double x) { return std::round(x * 1e4) / 1e4 + 0.0; };
  std::vector<std::array<glm::vec3, 3>> normals(split.ofTriangle.size());
  for (std::size_t t = 0; t < normals.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3& n = split.normals[split.corners[split.ofTriangle[t][k]].normal];
      normals[t][k] = glm::vec3(rounded(n.x), rounded(n.y), rounded(n.z));
    }
  }
  return normals;
}

}  // namespace sherd
