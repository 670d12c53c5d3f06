// Triangles that cross each other in a file of single precision.
#include "clean/rounded_crossings.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <iterator>
#include <vector>

#include "intersect/self_crossings.h"
#include "mesh/positions.h"

namespace sherd {
namespace {

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

// The pairs of triangles, numbered as in the mesh, that cross at these positions of its vertices.
//   isMoved  [triangles] 0 or 1: pairs with one that has 1 count
Pairs crossingsAt(const std::vector<glm::dvec3>& vertices, const TriangleMesh& mesh,
                  const std::vector<std::uint8_t>& isMoved, const Progress* progress) {
  const std::vector<std::uint32_t> position = firstAtPosition(vertices);
  std::vector<glm::uvec3> triangles;
  std::vector<std::uint32_t> number;
  std::vector<std::uint8_t> of;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& corner = mesh.triangles[t];
    const glm::uvec3 own(position[corner.x], position[corner.y], position[corner.z]);
    if (own.x == own.y || own.y == own.z || own.z == own.x) continue;
    triangles.push_back(own);
    number.push_back(t);
    of.push_back(isMoved[t]);
  }
  Pairs pairs = selfCrossings(vertices, triangles, progress, {.of = of});
  for (auto& pair : pairs) pair = {number[pair[0]], number[pair[1]]};
  return pairs;
}

// Marks the vertices that are of a crack and of the original surface; all where cracks are unknown.
std::vector<bool> verticesAtCuts(const TriangleMesh& mesh) {
  std::vector<bool> isAtCut(mesh.vertices.size(), mesh.neighbor.empty());
  std::vector<bool> isOfCrack(mesh.vertices.size());
  const auto visit = [&](bool ofCrack, const auto& mark) {
    for (std::size_t t = 0; t < mesh.neighbor.size(); ++t) {
      if ((mesh.neighbor[t] != 0) != ofCrack) continue;
      for (int k = 0; k < 3; ++k) mark(mesh.triangles[t][k]);
    }
  };
  visit(true, [&](std::uint32_t v) { isOfCrack[v] = true; });
  visit(false, [&](std::uint32_t v) { isAtCut[v] = isOfCrack[v]; });
  return isAtCut;
}

}  // namespace

std::size_t roundedCrossings(const TriangleMesh& mesh, const Progress* progress) {
  std::vector<glm::dvec3> rounded;
  rounded.reserve(mesh.vertices.size());
  for (const glm::dvec3& v : mesh.vertices) rounded.emplace_back(glm::vec3(v));
  const std::vector<bool> isAtCut = verticesAtCuts(mesh);
  std::vector<std::uint8_t> isMoved;
  isMoved.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    const bool any = rounded[t.x] != mesh.vertices[t.x] || rounded[t.y] != mesh.vertices[t.y] ||
                     rounded[t.z] != mesh.vertices[t.z];
    isMoved.push_back(any && (isAtCut[t.x] || isAtCut[t.y] || isAtCut[t.z]) ? 1 : 0);
  }
  if (std::find(isMoved.begin(), isMoved.end(), 1) == isMoved.end()) return 0;
  const Pairs after = crossingsAt(rounded, mesh, isMoved, progress);
  if (after.empty()) return 0;
  const Pairs before = crossingsAt(mesh.vertices, mesh, isMoved, progress);
  Pairs fresh;
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(),
                      std::back_inserter(fresh));
  return fresh.size();
}

}  // namespace sherd
