// Shapes that every test may use: closed meshes oriented outwards, each with the volume and area of
// its ideal shape. The polyhedron's own volume is volume(mesh); it lies a little below the ideal
// one where the shape is curved.
#pragma once

#include <sherd/mesh.h>

#include <glm/vec3.hpp>

namespace sherd::shapes {

/// Axis-aligned cube: 8 vertices, 12 triangles; the polyhedron is the ideal shape.
[[nodiscard]] TriangleMesh cube(double side, glm::dvec3 center = glm::dvec3(0.0));
[[nodiscard]] TriangleMesh box(glm::dvec3 sides);  ///< the same about the origin
[[nodiscard]] double cubeVolume(double side);      ///< side^3
[[nodiscard]] double cubeArea(double side);        ///< 6 side^2

/// Ball from a subdivided icosahedron: 20 * 4^subdivisions triangles, every vertex on the sphere.
[[nodiscard]] TriangleMesh ball(double radius, int subdivisions = 4,
                                glm::dvec3 center = glm::dvec3(0.0));
[[nodiscard]] double ballVolume(double radius);  ///< 4/3 pi radius^3
[[nodiscard]] double ballArea(double radius);    ///< 4 pi radius^2

/// Torus about the z axis, tube radius r around a circle of radius R: nu steps along the circle, nv
/// around the tube.
[[nodiscard]] TriangleMesh torus(double R, double r, int nu = 96, int nv = 48);
[[nodiscard]] double torusVolume(double R, double r);  ///< 2 pi^2 R r^2
[[nodiscard]] double torusArea(double R, double r);    ///< 4 pi^2 R r

/// Returns a mesh with neighbors.
[[nodiscard]] TriangleMesh withNeighbor(TriangleMesh mesh, std::vector<std::uint16_t> neighbor);

/// Cup about the z axis, standing on z = 0, open at the top.  The section on one side of the axis:
///
///            |  wall
///       axis |    +--+  height
///            |    |  |
///            |    |  |
///            +----+  |  floor
///            +-------+  0
///                    outerRadius
[[nodiscard]] TriangleMesh cup(double outerRadius, double wall, double height, double floor,
                               int segments = 96);
[[nodiscard]] double cupVolume(double outerRadius, double wall, double height, double floor);
[[nodiscard]] double cupArea(double outerRadius, double wall, double height, double floor);

/// Ball with a spherical cavity: two spheres about the origin, the inner one oriented inwards.
[[nodiscard]] TriangleMesh hollowBall(double outer, double inner, int subdivisions = 4);
[[nodiscard]] double hollowBallVolume(double outer, double inner);  ///< difference of the two balls
[[nodiscard]] double hollowBallArea(double outer, double inner);    ///< sum of the two spheres

/// Both meshes in one; nothing is merged.
[[nodiscard]] TriangleMesh append(const TriangleMesh& a, const TriangleMesh& b);
[[nodiscard]] TriangleMesh joined(const std::vector<TriangleMesh>& meshes);

/// scale * vertex + offset, scale > 0.
[[nodiscard]] TriangleMesh transformed(const TriangleMesh& mesh, double scale, glm::dvec3 offset);

/// The same surface seen from the other side.
[[nodiscard]] TriangleMesh inverted(const TriangleMesh& mesh);

}  // namespace sherd::shapes
