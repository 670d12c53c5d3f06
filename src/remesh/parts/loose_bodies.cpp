// Bodies of fragments that no crack connects to the rest.
#include "remesh/parts/loose_bodies.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include "base/union_find.h"
#include "mesh/positions.h"
#include "remesh/vertex_numbers.h"

namespace sherd {
namespace {

// Bodies of more than so many times the least volume are not looked at: they have voxels, or are
// too large to vanish.
constexpr double kMostLoose = 8.0;

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

// What connects two triangles: a vertex at one position, or an edge of the same vertices.
enum class Joint { position, edge };

// Returns [triangles] the first triangle of each one's part.
std::vector<std::uint32_t> partNames(const TriangleMesh& mesh, Joint joint) {
  const bool isPosition = joint == Joint::position;
  const std::vector<std::uint32_t> first =
      isPosition ? firstAtPosition(mesh.vertices) : std::vector<std::uint32_t>();
  UnionFind names(mesh.triangles.size());
  std::unordered_map<std::uint64_t, std::uint32_t> firstOf;  // of positions, or of edges
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& c = mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t a = c[k], b = c[(k + 1) % 3];
      const std::uint64_t key =
          isPosition ? std::uint64_t{first[c[k]]} : std::min(a, b) << 32 | std::max(a, b);
      names.unite(t, firstOf.try_emplace(key, t).first->second);
    }
  }
  return std::move(names).all();
}

//   other  [triangles] LabeledMesh::other, or empty
Parts partsOf(const TriangleMesh& mesh, const std::vector<std::uint16_t>& other, Joint joint) {
  Parts parts;
  if (mesh.triangles.empty()) return parts;
  parts.ofTriangle = partNames(mesh, joint);
  const glm::dvec3 from = mesh.vertices[mesh.triangles.front().x];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& c = mesh.triangles[t];
    Part& part = parts.all[parts.ofTriangle[t]];
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

// Returns the triangles of a part, with all vertices.
TriangleMesh partMesh(const TriangleMesh& mesh, const Parts& parts, std::uint32_t name) {
  TriangleMesh out;
  out.vertices = mesh.vertices;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (parts.ofTriangle[t] == name) out.triangles.push_back(mesh.triangles[t]);
  }
  return out;
}

std::size_t removeLoose(LabeledMesh& mesh, std::uint16_t id, double least,
                        const HasVoxels& hasVoxels) {
  const Parts parts = partsOf(mesh.mesh, mesh.other, Joint::edge);
  double largest = 0.0;
  for (const auto& [name, part] : parts.all) largest = std::max(largest, part.volume);
  std::vector<Box> removed;
  std::map<std::uint32_t, bool> isRemoved;
  for (const auto& [name, part] : parts.all) {
    if (part.hasCracks || !(part.volume > 0.0) || part.volume >= largest) continue;
    const bool isLoose =
        part.volume < least || (part.volume < kMostLoose * least &&
                                !hasVoxels(partMesh(mesh.mesh, parts, name), part.box, id));
    if (!isLoose) continue;
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

std::size_t removeLooseBodies(std::vector<LabeledMesh>& meshes, double least,
                              const HasVoxels& hasVoxels) {
  std::atomic<std::size_t> count = 0;
  tbb::parallel_for(std::size_t{0}, meshes.size(), [&](std::size_t i) {
    count += removeLoose(meshes[i], static_cast<std::uint16_t>(i + 1), least, hasVoxels);
  });
  return count;
}

std::size_t bodyCount(const TriangleMesh& mesh) {
  std::size_t count = 0;
  for (const auto& [name, part] : partsOf(mesh, {}, Joint::position).all)
    count += part.volume > 0.0;
  return count;
}

}  // namespace sherd
