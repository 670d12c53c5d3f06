// Triangles without area.
#include "remesh/flat_triangles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "base/sort_unique.h"
#include "intersect/crossing_point.h"
#include "mesh/largest_axis.h"
#include "remesh/face_edges.h"

namespace sherd {
namespace {

// Rounds of flips, each over triangles that are not neighbors.
constexpr int kMostRounds = 64;

bool isFlat(const TriangleMesh& mesh, const glm::uvec3& t) {
  return areCollinear({mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]});
}

// Returns k if the edge from corner k to the next is the longest of a flat triangle: the corner
// opposite is between the others.
int longestEdge(const TriangleMesh& mesh, const glm::uvec3& t) {
  const glm::dvec3 &a = mesh.vertices[t.x], &b = mesh.vertices[t.y], &c = mesh.vertices[t.z];
  const glm::dvec3 spread(std::abs(b.x - a.x) + std::abs(c.x - a.x),
                          std::abs(b.y - a.y) + std::abs(c.y - a.y),
                          std::abs(b.z - a.z) + std::abs(c.z - a.z));
  const int axis = largestAxis(spread);
  const auto isBetween = [&](const glm::dvec3& p, const glm::dvec3& from, const glm::dvec3& to) {
    return (p[axis] > from[axis]) != (p[axis] > to[axis]);
  };
  if (isBetween(c, a, b)) return 0;
  return isBetween(a, b, c) ? 1 : 2;
}

// The flip of a triangle's edge.
struct Flip {
  std::uint32_t triangle = 0, other = 0;
  glm::uvec3 first{0}, second{0};
};

// Returns nothing if the edge is not used once in each direction, or by one triangle from both
// sides.
std::optional<Flip> flipOf(const TriangleMesh& mesh, const FaceEdges& edges,
                           std::uint32_t triangle) {
  const int k = longestEdge(mesh, mesh.triangles[triangle]);
  const auto uses = edges.uses(edges.of(triangle)[static_cast<std::size_t>(k)]);
  if (uses.size() != 2 || uses[0].isForward == uses[1].isForward) return {};
  const FaceEdges::Use& beyond = uses[uses[0].face == triangle ? 1 : 0];
  const glm::uvec3 &t = mesh.triangles[triangle], &u = mesh.triangles[beyond.face];
  const std::uint32_t from = t[k], to = t[(k + 1) % 3], middle = t[(k + 2) % 3];
  const std::uint32_t apex = u[(beyond.corner + 2) % 3];
  if (apex == middle) return {};
  return Flip{triangle, beyond.face, {from, apex, middle}, {apex, to, middle}};
}

// Flips what can be flipped at once, and returns the triangles that are still flat; nothing if an
// edge can't be flipped.
std::optional<std::vector<std::uint32_t>> flipSome(TriangleMesh& mesh,
                                                   const std::vector<std::uint32_t>& flat) {
  const FaceEdges edges(mesh.triangles, mesh.vertices.size());
  std::vector<std::uint8_t> isChanged(mesh.triangles.size(), 0);
  std::vector<std::uint32_t> left = flat;
  for (const std::uint32_t triangle : flat) {
    if (isChanged[triangle] != 0) continue;
    std::optional<Flip> flip = flipOf(mesh, edges, triangle);
    if (!flip) return {};
    if (isChanged[flip->other] == 0 && isFlat(mesh, mesh.triangles[flip->other])) {
      // Of two flat triangles the longest edge, so that edges become shorter.
      flip = flipOf(mesh, edges, flip->other);
      if (!flip) return {};
    }
    if (isChanged[flip->triangle] != 0 || isChanged[flip->other] != 0) continue;
    isChanged[flip->triangle] = isChanged[flip->other] = 1;
    mesh.triangles[flip->triangle] = flip->first;
    mesh.triangles[flip->other] = flip->second;
    mesh.source[flip->triangle] = mesh.source[flip->other];
    left.insert(left.end(), {flip->triangle, flip->other});
  }
  sortUnique(left);
  const auto hasArea = [&](std::uint32_t t) { return !isFlat(mesh, mesh.triangles[t]); };
  left.erase(std::remove_if(left.begin(), left.end(), hasArea), left.end());
  return left;
}

}  // namespace

TriangleMesh withoutFlat(const TriangleMesh& mesh, std::vector<std::uint32_t> flat) {
  TriangleMesh out{mesh.vertices, mesh.triangles};
  out.source.resize(mesh.triangles.size());
  std::iota(out.source.begin(), out.source.end(), 0u);
  for (int round = 0; round < kMostRounds && !flat.empty(); ++round) {
    std::optional<std::vector<std::uint32_t>> left = flipSome(out, flat);
    if (!left) return {};
    flat = std::move(*left);
  }
  return flat.empty() ? out : TriangleMesh{};
}

}  // namespace sherd
