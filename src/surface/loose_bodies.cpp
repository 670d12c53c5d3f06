// Bodies of fragments that no crack connects to the rest.
#include "surface/loose_bodies.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <utility>

#include "base/union_find.h"
#include "mesh/positions.h"
#include "surface/vertex_numbers.h"

namespace sherd {
namespace {

// A part of a mesh that is connected.
struct Part {
  double volume = 0.0;
  bool hasCracks = false;
  Box box{glm::dvec3(std::numeric_limits<double>::infinity()),
          glm::dvec3(-std::numeric_limits<double>::infinity())};
};

struct Parts {
  std::vector<std::uint32_t> ofTriangle;  // the name of its part
  std::map<std::uint32_t, Part> all;
};

//   other  [triangles] LabeledMesh::other, or empty
Parts partsOf(const TriangleMesh& mesh, const std::vector<std::uint16_t>& other) {
  Parts parts;
  if (mesh.triangles.empty()) return parts;
  const std::vector<std::uint32_t> first = firstAtPosition(mesh.vertices);
  UnionFind names(mesh.vertices.size());
  for (const glm::uvec3& t : mesh.triangles) {
    names.unite(first[t.x], first[t.y]);
    names.unite(first[t.x], first[t.z]);
  }
  const glm::dvec3 from = mesh.vertices[mesh.triangles.front().x];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& c = mesh.triangles[t];
    parts.ofTriangle.push_back(names.find(first[c.x]));
    Part& part = parts.all[parts.ofTriangle.back()];
    const glm::dvec3 a = mesh.vertices[c.x] - from, b = mesh.vertices[c.y] - from,
                     d = mesh.vertices[c.z] - from;
    part.volume += glm::dot(a, glm::cross(b, d)) / 6.0;
    part.hasCracks = part.hasCracks || (!other.empty() && other[t] != 0);
    for (int k = 0; k < 3; ++k) {
      part.box.min = glm::min(part.box.min, mesh.vertices[c[k]]);
      part.box.max = glm::max(part.box.max, mesh.vertices[c[k]]);
    }
  }
  return parts;
}

bool isWithin(const Box& inner, const Box& outer) {
  return glm::all(glm::greaterThanEqual(inner.min, outer.min)) &&
         glm::all(glm::lessThanEqual(inner.max, outer.max));
}

// Removes triangles, and the vertices that only they have.
void keep(LabeledMesh& mesh, const std::vector<bool>& isKept) {
  std::vector<std::uint32_t> used;
  for (std::size_t t = 0; t < isKept.size(); ++t) {
    const glm::uvec3& c = mesh.mesh.triangles[t];
    if (isKept[t]) used.insert(used.end(), {c.x, c.y, c.z});
  }
  const VertexNumbers numbers(std::move(used), mesh.mesh.vertices.size());
  LabeledMesh out;
  for (const std::uint32_t v : numbers.vertices()) {
    out.mesh.vertices.push_back(mesh.mesh.vertices[v]);
    if (!mesh.positionId.empty()) out.positionId.push_back(mesh.positionId[v]);
  }
  for (std::size_t t = 0; t < isKept.size(); ++t) {
    if (!isKept[t]) continue;
    const glm::uvec3& c = mesh.mesh.triangles[t];
    out.mesh.triangles.emplace_back(numbers.of(c.x), numbers.of(c.y), numbers.of(c.z));
    out.other.push_back(mesh.other[t]);
    if (!mesh.mesh.source.empty()) out.mesh.source.push_back(mesh.mesh.source[t]);
  }
  mesh = std::move(out);
}

std::size_t removeLoose(LabeledMesh& mesh, double least) {
  const Parts parts = partsOf(mesh.mesh, mesh.other);
  double largest = 0.0;
  for (const auto& [name, part] : parts.all) largest = std::max(largest, part.volume);
  std::vector<Box> removed;
  std::map<std::uint32_t, bool> isRemoved;
  for (const auto& [name, part] : parts.all) {
    const bool isLoose = part.volume > 0.0 && part.volume < std::min(least, largest);
    if (!isLoose || part.hasCracks) continue;
    isRemoved[name] = true;
    removed.push_back(part.box);
  }
  if (removed.empty()) return 0;
  for (const auto& [name, part] : parts.all) {  // their cavities
    if (part.volume > 0.0 || part.hasCracks) continue;
    const Box& own = part.box;
    const bool isTheirs =
        std::ranges::any_of(removed, [&](const Box& box) { return isWithin(own, box); });
    if (isTheirs) isRemoved[name] = true;
  }
  std::vector<bool> isKept;
  for (const std::uint32_t name : parts.ofTriangle) isKept.push_back(!isRemoved.contains(name));
  keep(mesh, isKept);
  return removed.size();
}

}  // namespace

std::size_t removeLooseBodies(std::vector<LabeledMesh>& meshes, double least) {
  std::atomic<std::size_t> count = 0;
  tbb::parallel_for(std::size_t{0}, meshes.size(),
                    [&](std::size_t i) { count += removeLoose(meshes[i], least); });
  return count;
}

std::size_t bodyCount(const TriangleMesh& mesh) {
  std::size_t count = 0;
  for (const auto& [name, part] : partsOf(mesh, {}).all) count += part.volume > 0.0;
  return count;
}

}  // namespace sherd
