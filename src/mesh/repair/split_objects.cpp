// Splitting of a file's objects into separate meshes.
#include <sherd/mesh.h>

#include <cstdint>
#include <limits>

#include "base/chosen.h"

namespace sherd {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Returns the faces of some triangles.
std::vector<PolygonPart> facesOf(const SourceMesh& source,
                                 const std::vector<std::uint32_t>& triangles) {
  std::vector<PolygonPart> faces = chosen(source.polygons, triangles);
  if (!source.polygons.empty()) return faces;
  faces.reserve(triangles.size());
  for (const std::uint32_t t : triangles) faces.push_back({t, {0, 1, 2}});
  return faces;
}

}  // namespace

std::vector<SourceMesh> splitObjects(const SourceMesh& source) {
  if (source.objects.empty() || source.objectOfTriangle.empty()) return {source};
  std::vector<std::vector<std::uint32_t>> trianglesOf(source.objects.size());
  for (std::uint32_t t = 0; t < source.objectOfTriangle.size(); ++t) {
    trianglesOf[source.objectOfTriangle[t]].push_back(t);
  }
  std::vector<SourceMesh> meshes;
  std::vector<std::uint32_t> number(source.mesh.vertices.size(), kNone);  // new index of a vertex
  for (std::size_t object = 0; object < trianglesOf.size(); ++object) {
    const std::vector<std::uint32_t>& triangles = trianglesOf[object];
    if (triangles.empty()) continue;
    SourceMesh out;
    out.name = source.name;
    out.stem = source.stem;
    out.sha256 = source.sha256;
    out.coordinates = source.coordinates;
    out.objects = {source.objects[object]};
    out.objectOfTriangle.assign(triangles.size(), 0);
    out.polygons = facesOf(source, triangles);
    out.mesh.triangles = chosen(source.mesh.triangles, triangles);
    std::vector<std::uint32_t> used;
    for (glm::uvec3& triangle : out.mesh.triangles) {
      for (int corner = 0; corner < 3; ++corner) {
        std::uint32_t& vertex = triangle[corner];
        if (number[vertex] == kNone) {
          number[vertex] = static_cast<std::uint32_t>(used.size());
          used.push_back(vertex);
          out.mesh.vertices.push_back(source.mesh.vertices[vertex]);
        }
        vertex = number[vertex];
      }
    }
    for (const std::uint32_t vertex : used) number[vertex] = kNone;
    out.fileVertices = out.mesh.vertices.size();
    out.appearance.materials = source.appearance.materials;
    out.appearance.textures = source.appearance.textures;
    out.mesh.neighbor = chosen(source.mesh.neighbor, triangles);
    const SurfaceAttributes& attributes = source.mesh.attributes;
    out.mesh.attributes = {
        chosen(attributes.texcoords, triangles), chosen(attributes.colors, triangles),
        chosen(attributes.material, triangles), chosen(attributes.normals, triangles)};
    if (meshes.empty()) {
      out.warnings = source.warnings;
      out.degenerateTriangles = source.degenerateTriangles;
      out.droppedVertices = source.droppedVertices;
      out.droppedTriangles = source.droppedTriangles;
    }
    meshes.push_back(std::move(out));
  }
  return meshes;
}

}  // namespace sherd
