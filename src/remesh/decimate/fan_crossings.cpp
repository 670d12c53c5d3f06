// Compares the faces that an edge collapse changes with those around them.
#include "remesh/decimate/fan_crossings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "base/sort_unique.h"
#include "intersect/self_crossings.h"
#include "mesh/search/boxes.h"

namespace sherd {
namespace {

using Index = CollapsingMesh::Index;

// Much more than the rounding error of a distance from a plane in relation to the corners' own.
constexpr double kRounding = 1e-12;

struct Face {
  glm::uvec3 vertex{0};
  std::array<glm::dvec3, 3> corner{};
  Box box{};
  glm::dvec3 normal{0.0};  // of length twice the area
  double rounding = 0.0;  // of a distance from its plane times that length, for each unit of length

  bool has(Index v) const { return vertex.x == v || vertex.y == v || vertex.z == v; }
};

glm::dvec3 normalOf(const std::array<glm::dvec3, 3>& corner) {
  return glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
}

double sumOfAbs(const glm::dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

Face faceOf(const glm::uvec3& vertex, const std::array<glm::dvec3, 3>& corner) {
  const glm::dvec3 normal = normalOf(corner);
  return {vertex, corner, boxOf(corner), normal, kRounding * sumOfAbs(normal)};
}

// Whether all of a face is in front of another's plane, or all behind it, but for common vertices.
bool isBeside(const Face& face, const Face& plane) {
  bool isFront = false, isBehind = false;
  for (int k = 0; k < 3; ++k) {
    if (plane.has(face.vertex[k])) continue;
    const glm::dvec3 to = face.corner[static_cast<std::size_t>(k)] - plane.corner[0];
    const double distance = glm::dot(plane.normal, to);
    const double least = plane.rounding * (1.0 + sumOfAbs(to));
    isFront = isFront || !(distance < -least);
    isBehind = isBehind || !(distance > least);
    if (isFront && isBehind) return false;
  }
  return true;
}

bool cross(const Face& a, const Face& b) {
  if (!meet(a.box, b.box) || isBeside(a, b) || isBeside(b, a)) return false;
  std::array<glm::dvec3, 6> points;
  std::copy(a.corner.begin(), a.corner.end(), points.begin());
  std::copy(b.corner.begin(), b.corner.end(), points.begin() + 3);
  glm::uvec3 other(3, 4, 5);
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      if (b.vertex[k] == a.vertex[j]) other[k] = static_cast<unsigned>(j);
    }
  }
  return trianglesCross(points, {0, 1, 2}, other);
}

// Whether the faces of a fan, and those around it, all face one side, as those of a height field,
// which do not cross.  Of each face one vertex is looked at: around `a` they are all.
bool isHeightField(const CollapsingMesh& mesh, std::span<const glm::dvec3> at, Index a, Index b,
                   std::span<const Face> fan) {
  glm::dvec3 up(0.0);
  for (const Face& own : fan) up += own.normal;
  for (const Face& own : fan) {
    if (!(glm::dot(own.normal, up) > 0.0)) return false;
    const Index next = own.vertex.x == a   ? own.vertex.y
                       : own.vertex.y == a ? own.vertex.z
                                           : own.vertex.x;
    for (const Index g : mesh.facesAround(next)) {
      if (mesh.has(g, a) || mesh.has(g, b)) continue;
      const glm::uvec3& t = mesh.faces()[g].corner;
      if (!(glm::dot(normalOf({at[t.x], at[t.y], at[t.z]}), up) > 0.0)) return false;
    }
  }
  return true;
}

// The faces around a collapsed edge, as they would be.
std::vector<Face> fanOf(const CollapsingMesh& mesh, std::span<const glm::dvec3> at, Index a,
                        Index b, const glm::dvec3& target) {
  std::vector<Face> fan;
  fan.reserve(mesh.facesAround(a).size() + mesh.facesAround(b).size());
  for (const Index v : {a, b}) {
    for (const Index f : mesh.facesAround(v)) {
      if (mesh.has(f, a) && mesh.has(f, b)) continue;
      glm::uvec3 vertex = mesh.faces()[f].corner;
      std::array<glm::dvec3, 3> corner;
      for (int k = 0; k < 3; ++k) {
        if (vertex[k] == v) {
          vertex[k] = a;
          corner[static_cast<std::size_t>(k)] = target;
          continue;
        }
        corner[static_cast<std::size_t>(k)] = at[vertex[k]];
      }
      fan.push_back(faceOf(vertex, corner));
    }
  }
  return fan;
}

// Whether a face around a fan crosses one of it.
bool crossesFan(const glm::uvec3& vertex, std::span<const glm::dvec3> at, std::span<const Face> fan,
                const Box& ofFan) {
  const std::array<glm::dvec3, 3> corner{at[vertex.x], at[vertex.y], at[vertex.z]};
  if (!meet(ofFan, boxOf(corner))) return false;
  const Face other = faceOf(vertex, corner);
  return std::any_of(fan.begin(), fan.end(), [&](const Face& own) { return cross(own, other); });
}

}  // namespace

bool fanCrosses(const CollapsingMesh& mesh, std::span<const glm::dvec3> at, Index a, Index b,
                const glm::dvec3& target) {
  const std::vector<Face> fan = fanOf(mesh, at, a, b, target);
  if (isHeightField(mesh, at, a, b, fan)) return false;
  for (std::size_t i = 0; i < fan.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (cross(fan[i], fan[j])) return true;
    }
  }
  std::vector<Index> ring;
  ring.reserve(2 * fan.size());
  Box ofFan{target, target};
  for (const Face& own : fan) {
    ofFan = {glm::min(ofFan.min, own.box.min), glm::max(ofFan.max, own.box.max)};
    for (int k = 0; k < 3; ++k) {
      if (own.vertex[k] != a) ring.push_back(own.vertex[k]);
    }
  }
  sortUnique(ring);
  for (const Index v : ring) {
    // Faces at several vertices of the ring are looked at once.
    const auto isSeen = [&](Index other) {
      return other < v && std::binary_search(ring.begin(), ring.end(), other);
    };
    for (const Index g : mesh.facesAround(v)) {
      const glm::uvec3& t = mesh.faces()[g].corner;
      if (mesh.has(g, a) || mesh.has(g, b) || isSeen(t.x) || isSeen(t.y) || isSeen(t.z)) continue;
      if (crossesFan(t, at, fan, ofFan)) return true;
    }
  }
  return false;
}

}  // namespace sherd
