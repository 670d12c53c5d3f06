// On which side of a mesh a point lies.
#include "mesh/search/sided_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <utility>

#include "base/infinity.h"
#include "mesh/search/nearest_on_triangle.h"
#include "mesh/vertex_normals.h"

namespace sherd {
namespace {

TriangleMesh withArea(TriangleMesh mesh) {
  std::erase_if(mesh.triangles,
                [&](const glm::uvec3& t) { return cornersOf(mesh, t).normal == glm::dvec3(0.0); });
  return {std::move(mesh.vertices), std::move(mesh.triangles)};
}

// An edge of a triangle, by its vertices in ascending order.
struct Edge {
  std::uint64_t key;
  std::uint32_t triangle;
  int corner;
};

// Returns the edges, those of the same vertices side by side.
std::vector<Edge> sortedEdges(const TriangleMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      edges.push_back({std::uint64_t{std::min(a, b)} << 32 | std::max(a, b), t, k});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::pair(a.key, a.triangle) < std::pair(b.key, b.triangle);
  });
  return edges;
}

TriangleMesh edgesAsTriangles(const TriangleMesh& mesh,
                              const std::vector<std::array<bool, 3>>& isBorder) {
  TriangleMesh edges{mesh.vertices, {}};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (!isBorder[t][static_cast<std::size_t>(k)]) continue;
      const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      edges.triangles.emplace_back(a, b, b);
    }
  }
  return edges;
}

}  // namespace

SidedMesh::SidedMesh(TriangleMesh mesh, Shape shape)
    : mesh_(withArea(std::move(mesh))),
      tree_(shape == Shape::strip ? TriangleTree::ofStrip(mesh_) : TriangleTree(mesh_)),
      border_(TriangleMesh{}) {
  const std::size_t triangles = mesh_.triangles.size();
  for (const glm::uvec3& t : mesh_.triangles) faceNormals_.push_back(cornersOf(mesh_, t).normal);
  vertexNormals_ = vertexNormals(mesh_);
  edgeNormals_.resize(triangles);
  isBorderEdge_.resize(triangles);
  isBorderVertex_.resize(mesh_.vertices.size());
  const std::vector<Edge> edges = sortedEdges(mesh_);
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    glm::dvec3 sum(0.0);
    for (end = i; end < edges.size() && edges[end].key == edges[i].key; ++end) {
      sum += faceNormals_[edges[end].triangle];
    }
    for (std::size_t k = i; k < end; ++k) {
      const auto corner = static_cast<std::size_t>(edges[k].corner);
      edgeNormals_[edges[k].triangle][corner] = unitOrZero(sum);
      isBorderEdge_[edges[k].triangle][corner] = end - i == 1;
    }
    if (end - i > 1) continue;
    isBorderVertex_[edges[i].key >> 32] = isBorderVertex_[edges[i].key & 0xffffffffu] = true;
  }
  border_ = TriangleTree(edgesAsTriangles(mesh_, isBorderEdge_));
}

SidedMesh::Side SidedMesh::sideOf(const glm::dvec3& point, std::uint32_t guess) const {
  const TriangleTree::Nearest nearest = tree_.nearest(point, kInfinity, guess);
  const std::uint32_t triangle = tree_.source(nearest.triangle);
  const std::array<glm::dvec3, 3> t = tree_.corners(nearest.triangle);
  const ClosestOfTriangle closest = closestOfTriangle(point, t[0], t[1], t[2]);
  const auto corner = static_cast<std::size_t>(closest.corner);
  glm::dvec3 normal = faceNormals_[triangle];
  bool isBorder = false;
  if (closest.feature == TriangleFeature::vertex) {
    const std::uint32_t vertex = mesh_.triangles[triangle][closest.corner];
    if (vertexNormals_[vertex] != glm::dvec3(0.0)) normal = vertexNormals_[vertex];
    isBorder = isBorderVertex_[vertex];
  } else if (closest.feature == TriangleFeature::edge) {
    const glm::dvec3& ofEdge = edgeNormals_[triangle][corner];
    if (ofEdge != glm::dvec3(0.0)) normal = ofEdge;
    isBorder = isBorderEdge_[triangle][corner];
  }
  const double along = glm::dot(point - closest.point, normal);
  const double distance = isBorder ? along : std::copysign(nearest.distance, along);
  return {distance, nearest.distance, nearest.triangle};
}

// Within `reach` the closest point of the mesh is at most toMesh + reach away, and the border at
// least its own distance less `reach`.
bool SidedMesh::isOneSided(const glm::dvec3& point, const Side& side, double reach) const {
  if (side.toMesh <= reach) return false;
  return border_.empty() ||
         border_.nearest(point, side.toMesh + 2.0 * reach).triangle == TriangleTree::kNone;
}

}  // namespace sherd
