// Shapes that every test may use.
#include "shapes.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <utility>

namespace sherd::shapes {
namespace {

constexpr double kPi = std::numbers::pi;

using Index = std::uint32_t;

// The icosahedron inscribed in the unit sphere.
TriangleMesh icosahedron() {
  const double t = std::numbers::phi;
  TriangleMesh mesh;
  mesh.vertices = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                   {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  for (glm::dvec3& v : mesh.vertices) v = glm::normalize(v);
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return mesh;
}

// Every triangle in four, new vertices on the unit sphere.
TriangleMesh subdivided(const TriangleMesh& mesh) {
  TriangleMesh out{mesh.vertices, {}};
  std::map<std::pair<Index, Index>, Index> midpoints;
  const auto midpoint = [&](Index a, Index b) {
    const auto [at, isNew] =
        midpoints.try_emplace(std::minmax(a, b), static_cast<Index>(out.vertices.size()));
    if (isNew) out.vertices.push_back(glm::normalize(out.vertices[a] + out.vertices[b]));
    return at->second;
  };
  for (const glm::uvec3& t : mesh.triangles) {
    const Index xy = midpoint(t.x, t.y), yz = midpoint(t.y, t.z), zx = midpoint(t.z, t.x);
    for (const glm::uvec3& part :
         {glm::uvec3(t.x, xy, zx), {t.y, yz, xy}, {t.z, zx, yz}, {xy, yz, zx}})
      out.triangles.push_back(part);
  }
  return out;
}

}  // namespace

TriangleMesh cube(double side, glm::dvec3 center) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)  // bit 2: x, bit 1: y, bit 0: z
    mesh.vertices.push_back(center + side * (glm::dvec3(i >> 2, (i >> 1) & 1, i & 1) - 0.5));
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  return mesh;
}

TriangleMesh box(glm::dvec3 sides) {
  TriangleMesh mesh = cube(1.0);
  for (glm::dvec3& v : mesh.vertices) v = v * sides;
  return mesh;
}

double cubeVolume(double side) { return side * side * side; }
double cubeArea(double side) { return 6.0 * side * side; }

TriangleMesh ball(double radius, int subdivisions, glm::dvec3 center) {
  TriangleMesh mesh = icosahedron();
  for (int i = 0; i < subdivisions; ++i) mesh = subdivided(mesh);
  return transformed(mesh, radius, center);
}

double ballVolume(double radius) { return 4.0 / 3.0 * kPi * radius * radius * radius; }
double ballArea(double radius) { return 4.0 * kPi * radius * radius; }

TriangleMesh torus(double R, double r, int nu, int nv) {
  assert(r < R && nu >= 3 && nv >= 3);
  TriangleMesh mesh;
  for (int i = 0; i < nu; ++i) {
    const double u = 2.0 * kPi * i / nu;
    for (int j = 0; j < nv; ++j) {
      const double v = 2.0 * kPi * j / nv, distance = R + r * std::cos(v);
      mesh.vertices.emplace_back(distance * std::cos(u), distance * std::sin(u), r * std::sin(v));
    }
  }
  const auto at = [&](int i, int j) { return static_cast<Index>((i % nu) * nv + j % nv); };
  for (int i = 0; i < nu; ++i) {
    for (int j = 0; j < nv; ++j) {
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      mesh.triangles.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return mesh;
}

double torusVolume(double R, double r) { return 2.0 * kPi * kPi * R * r * r; }
double torusArea(double R, double r) { return 4.0 * kPi * kPi * R * r; }

TriangleMesh withNeighbor(TriangleMesh mesh, std::vector<std::uint16_t> neighbor) {
  mesh.neighbor = std::move(neighbor);
  return mesh;
}

TriangleMesh cup(double outerRadius, double wall, double height, double floor, int segments) {
  assert(wall < outerRadius && floor < height && segments >= 3);
  const double innerRadius = outerRadius - wall;
  // The section from the bottom's center outwards, up, over the lip and down to the floor's center:
  // four rings between two points on the axis.
  const std::array<glm::dvec2, 4> rings{
      {{outerRadius, 0.0}, {outerRadius, height}, {innerRadius, height}, {innerRadius, floor}}};
  const auto ringVertex = [&](int ring, int i) {
    return static_cast<Index>(2 + ring * segments + i % segments);
  };
  TriangleMesh mesh;
  mesh.vertices = {{0.0, 0.0, 0.0}, {0.0, 0.0, floor}};
  for (const glm::dvec2& ring : rings) {
    for (int i = 0; i < segments; ++i) {
      const double angle = 2.0 * kPi * i / segments;
      mesh.vertices.emplace_back(ring.x * std::cos(angle), ring.x * std::sin(angle), ring.y);
    }
  }
  for (int i = 0; i < segments; ++i) {
    mesh.triangles.emplace_back(0u, ringVertex(0, i + 1), ringVertex(0, i));
    for (int ring = 0; ring < 3; ++ring) {
      mesh.triangles.emplace_back(ringVertex(ring, i), ringVertex(ring, i + 1),
                                  ringVertex(ring + 1, i + 1));
      mesh.triangles.emplace_back(ringVertex(ring, i), ringVertex(ring + 1, i + 1),
                                  ringVertex(ring + 1, i));
    }
    mesh.triangles.emplace_back(1u, ringVertex(3, i), ringVertex(3, i + 1));
  }
  return mesh;
}

double cupVolume(double outerRadius, double wall, double height, double floor) {
  const double innerRadius = outerRadius - wall;
  return kPi * (outerRadius * outerRadius * height - innerRadius * innerRadius * (height - floor));
}

double cupArea(double outerRadius, double wall, double height, double floor) {
  const double innerRadius = outerRadius - wall;
  // Bottom; outer side; inner side; lip and floor, which together are one more disc of the outer
  // radius.
  return 2.0 * kPi *
         (outerRadius * outerRadius + outerRadius * height + innerRadius * (height - floor));
}

TriangleMesh hollowBall(double outer, double inner, int subdivisions) {
  assert(inner < outer);
  return append(ball(outer, subdivisions), inverted(ball(inner, subdivisions)));
}

double hollowBallVolume(double outer, double inner) {
  return ballVolume(outer) - ballVolume(inner);
}
double hollowBallArea(double outer, double inner) { return ballArea(outer) + ballArea(inner); }

TriangleMesh joined(const std::vector<TriangleMesh>& meshes) {
  TriangleMesh all;
  for (const TriangleMesh& mesh : meshes) all = append(all, mesh);
  return all;
}

TriangleMesh append(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh out = a;
  out.vertices.insert(out.vertices.end(), b.vertices.begin(), b.vertices.end());
  const auto offset = static_cast<Index>(a.vertices.size());
  for (const glm::uvec3& t : b.triangles) out.triangles.push_back(t + offset);
  return out;
}

TriangleMesh transformed(const TriangleMesh& mesh, double scale, glm::dvec3 offset) {
  assert(scale > 0.0);
  TriangleMesh out = mesh;
  for (glm::dvec3& v : out.vertices) v = scale * v + offset;
  return out;
}

TriangleMesh inverted(const TriangleMesh& mesh) {
  TriangleMesh out = mesh;
  for (glm::uvec3& t : out.triangles) std::swap(t.y, t.z);
  return out;
}

}  // namespace sherd::shapes
