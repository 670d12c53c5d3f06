// A file's parts as meshes of their own.
#include <sherd/mesh.h>

#include <cstdint>
#include <limits>

#include "base/chosen.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

}  // namespace

std::vector<SourceMesh> splitObjects(const SourceMesh& source) {
  if (source.objects.empty() || source.objectOfTriangle.empty()) return {source};
  std::vector<std::vector<std::uint32_t>> trianglesOf(source.objects.size());
  for (std::uint32_t t = 0; t < source.objectOfTriangle.size(); ++t) {
    trianglesOf[source.objectOfTriangle[t]].push_back(t);
  }
  std::vector<SourceMesh> parts;
  std::vector<std::uint32_t> number(source.mesh.vertices.size(), kNone);  // of a vertex in the part
  for (std::size_t object = 0; object < trianglesOf.size(); ++object) {
    const std::vector<std::uint32_t>& triangles = trianglesOf[object];
    if (triangles.empty()) continue;
    SourceMesh part;
    part.name = source.name;
    part.stem = source.stem;
    part.sha256 = source.sha256;
    part.objects = {source.objects[object]};
    part.objectOfTriangle.assign(triangles.size(), 0);
    part.mesh.triangles = chosen(source.mesh.triangles, triangles);
    std::vector<std::uint32_t> used;
    for (glm::uvec3& triangle : part.mesh.triangles) {
      for (int corner = 0; corner < 3; ++corner) {
        std::uint32_t& vertex = triangle[corner];
        if (number[vertex] == kNone) {
          number[vertex] = static_cast<std::uint32_t>(used.size());
          used.push_back(vertex);
          part.mesh.vertices.push_back(source.mesh.vertices[vertex]);
        }
        vertex = number[vertex];
      }
    }
    for (const std::uint32_t vertex : used) number[vertex] = kNone;
    part.fileVertices = part.mesh.vertices.size();
    part.appearance.materials = source.appearance.materials;
    part.appearance.textures = source.appearance.textures;
    const SurfaceLook& look = source.appearance.surface;
    part.appearance.surface = {chosen(look.texcoords, triangles), chosen(look.colours, triangles),
                               chosen(look.material, triangles)};
    if (parts.empty()) {
      part.warnings = source.warnings;
      part.degenerateTriangles = source.degenerateTriangles;
      part.droppedVertices = source.droppedVertices;
      part.droppedTriangles = source.droppedTriangles;
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace sherd
