// Triangulates meshes whose faces have any number of corners.
#include "formats/mesh/polygon_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "base/chosen.h"
#include "base/finite.h"
#include "formats/mesh/triangulate.h"

namespace sherd {
namespace {

// Triangles of all faces, as indices of corners, and the face of each.
struct Triangles {
  std::vector<glm::uvec3> corners;
  std::vector<std::uint32_t> face;
};

// Corners between two checks for cancellation.
constexpr std::uint32_t kCornersAtATime = 4096;

// Returns the largest number of corners of a face.
std::size_t longestFace(const PolygonMesh& mesh) {
  std::uint32_t longest = 0, begin = 0;
  for (const std::uint32_t end : mesh.faceEnds) {
    longest = std::max(longest, end - begin);
    begin = end;
  }
  return longest;
}

// Whether triangles are the faces of the file, each in its place.
bool areAllTriangles(const PolygonMesh& mesh, std::size_t triangles) {
  return triangles == mesh.faceEnds.size() && mesh.faceIndices.empty();
}

// Returns the place of each triangle in its face; nothing if all faces are triangles.
std::vector<PolygonPart> partsOf(const PolygonMesh& mesh, const Triangles& triangles) {
  std::vector<PolygonPart> parts;
  if (areAllTriangles(mesh, triangles.face.size())) return parts;
  parts.reserve(triangles.face.size());
  for (std::size_t t = 0; t < triangles.face.size(); ++t) {
    const std::uint32_t face = triangles.face[t];
    parts.push_back({mesh.faceIndices.empty() ? face : mesh.faceIndices[face],
                     triangles.corners[t] - (face == 0 ? 0 : mesh.faceEnds[face - 1])});
  }
  return parts;
}

Triangles triangulated(const MeshFile& file, const PolygonMesh& mesh) {
  // One face at a time: its corners and its triangles.
  const std::size_t longest = longestFace(mesh);
  const TransientMemory transient(file.memory);
  charge(file, longest, sizeof(std::uint32_t) + sizeof(glm::uvec3));
  Triangles out;
  const std::size_t count = mesh.corners.size() - 2 * mesh.faceEnds.size();
  out.corners.reserve(count);
  out.face.reserve(count);
  std::vector<glm::uvec3> faceTriangles;
  faceTriangles.reserve(longest);
  std::uint32_t begin = 0, seen = 0;
  for (std::uint32_t face = 0; face < mesh.faceEnds.size(); ++face) {
    const std::uint32_t end = mesh.faceEnds[face];
    if (end - seen >= kCornersAtATime) {
      checkpoint(file);
      seen = end;
    }
    if (end - begin == 3) {
      out.corners.emplace_back(begin, begin + 1, begin + 2);
      out.face.push_back(face);
    } else {
      faceTriangles.clear();
      triangulate(mesh.vertices, std::span(mesh.corners).subspan(begin, end - begin),
                  faceTriangles);
      for (const glm::uvec3& t : faceTriangles) out.corners.push_back(t + begin);
      out.face.insert(out.face.end(), faceTriangles.size(), face);
    }
    begin = end;
  }
  return out;
}

template <class Value>
std::vector<std::array<Value, 3>> atCorners(const std::vector<Value>& values,
                                            const std::vector<glm::uvec3>& triangles) {
  std::vector<std::array<Value, 3>> out;
  if (values.empty()) return out;
  out.reserve(triangles.size());
  for (const glm::uvec3& t : triangles) out.push_back({values[t.x], values[t.y], values[t.z]});
  return out;
}

template <class Value>
std::uint64_t bytesOf(const std::vector<Value>& values) {
  return values.size() * sizeof(Value);
}

}  // namespace

std::uint64_t PolygonMesh::bytes() const {
  return bytesOf(vertices) + bytesOf(corners) + bytesOf(faceEnds) + bytesOf(vertexColors) +
         bytesOf(faceColors) + bytesOf(vertexTexcoords) + bytesOf(cornerTexcoords) +
         bytesOf(vertexNormals) + bytesOf(cornerNormals) + bytesOf(faceMaterials) +
         bytesOf(faceNeighbors) + bytesOf(objectOfFace) + bytesOf(faceIndices);
}

void PolygonMesh::endFace() {
  if (facesLeftOut > 0) {
    faceIndices.push_back(static_cast<std::uint32_t>(faceEnds.size()) + facesLeftOut);
  }
  faceEnds.push_back(static_cast<std::uint32_t>(corners.size()));
}

void PolygonMesh::leaveOutFace() {
  if (facesLeftOut++ > 0) return;
  faceIndices.resize(faceEnds.size());
  std::iota(faceIndices.begin(), faceIndices.end(), 0u);
}

void triangulateInto(const MeshFile& file, PolygonMesh&& mesh, RawMesh& out) {
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max();
  if (mesh.vertices.size() > kMost || mesh.corners.size() > kMost) {
    throw inputError(file,
                     "has more than 2^32 vertices or corners of faces, which is more than "
                     "can be held");
  }
  // For each triangle its corners twice, its face and its attributes.
  const std::uint64_t count = mesh.corners.size() - 2 * mesh.faceEnds.size();
  const bool colors = !mesh.vertexColors.empty() || !mesh.faceColors.empty();
  const bool texcoords = !mesh.vertexTexcoords.empty() || !mesh.cornerTexcoords.empty();
  const bool normals = !mesh.vertexNormals.empty() || !mesh.cornerNormals.empty();
  charge(file, count,
         2 * sizeof(glm::uvec3) + sizeof(std::uint32_t) + (colors ? 3 * sizeof(glm::u8vec3) : 0) +
             (texcoords ? 3 * sizeof(glm::vec2) : 0) + (normals ? 3 * sizeof(glm::vec3) : 0) +
             (mesh.faceMaterials.empty() ? 0 : sizeof(std::uint32_t)) +
             (mesh.faceNeighbors.empty() ? 0 : sizeof(std::uint16_t)) +
             (mesh.objectOfFace.empty() ? 0 : sizeof(std::uint32_t)) +
             (areAllTriangles(mesh, count) ? 0 : sizeof(PolygonPart)));
  const Triangles triangles = triangulated(file, mesh);
  out.triangles.reserve(triangles.corners.size());
  for (const glm::uvec3& t : triangles.corners) {
    out.triangles.emplace_back(mesh.corners[t.x], mesh.corners[t.y], mesh.corners[t.z]);
  }
  SurfaceAttributes& attributes = out.attributes;
  attributes.colors = atCorners(mesh.vertexColors, out.triangles);
  for (const glm::u8vec3& color : chosen(mesh.faceColors, triangles.face)) {
    attributes.colors.push_back({color, color, color});
  }
  attributes.texcoords = mesh.vertexTexcoords.empty()
                             ? atCorners(mesh.cornerTexcoords, triangles.corners)
                             : atCorners(mesh.vertexTexcoords, out.triangles);
  for (auto& corners : attributes.texcoords) {
    for (glm::vec2& at : corners) {
      if (!isFinite(at)) at = glm::vec2(0.0f);
    }
  }
  attributes.normals = mesh.vertexNormals.empty() ? atCorners(mesh.cornerNormals, triangles.corners)
                                                  : atCorners(mesh.vertexNormals, out.triangles);
  attributes.material = chosen(mesh.faceMaterials, triangles.face);
  out.neighbor = chosen(mesh.faceNeighbors, triangles.face);
  out.objectOfTriangle = chosen(mesh.objectOfFace, triangles.face);
  out.polygons = partsOf(mesh, triangles);
  out.vertices = std::move(mesh.vertices);
}

}  // namespace sherd
