// The closest point of a triangle.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace sherd {

/// A part of a triangle.
enum class TriangleFeature { vertex, edge, face };

struct ClosestOfTriangle {
  glm::dvec3 point{0.0};
  TriangleFeature feature = TriangleFeature::face;
  int corner = 0;  ///< the vertex, or the first one of the edge, counter-clockwise
};

/// Returns the point of triangle a, b, c that is closest to p, and the part that it lies on; valid
/// for degenerate triangles, too.
/// source  Ericson, Real-Time Collision Detection, 2005, section 5.1.5
inline ClosestOfTriangle closestOfTriangle(const glm::dvec3& p, const glm::dvec3& a,
                                           const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, TriangleFeature::vertex, 0};
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return {b, TriangleFeature::vertex, 1};
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return {c, TriangleFeature::vertex, 2};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    return {a + d1 / (d1 - d3) * ab, TriangleFeature::edge, 0};
  }
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    return {a + d2 / (d2 - d6) * ac, TriangleFeature::edge, 2};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return {b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), TriangleFeature::edge, 1};
  }
  const double inverse = 1.0 / (va + vb + vc);
  return {a + vb * inverse * ab + vc * inverse * ac, TriangleFeature::face, 0};
}

/// Returns only the point.
inline glm::dvec3 nearestOnTriangle(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                                    const glm::dvec3& c) {
  return closestOfTriangle(p, a, b, c).point;
}

}  // namespace sherd
