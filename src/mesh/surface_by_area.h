// Sampling of a surface by area.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace sherd {

/// A triangle of a surface.
struct SurfaceTriangle {
  std::array<glm::dvec3, 3> corner{};
  std::uint16_t neighbor = 0;

  /// Returns a point that is uniform in the triangle if u and v are uniform in [0, 1).
  [[nodiscard]] glm::dvec3 pointIn(double u, double v) const;

  /// Returns the shares of the corners in that point.
  [[nodiscard]] static std::array<double, 3> sharesAt(double u, double v);

  /// Returns the unit normal; the triangle must have an area.
  [[nodiscard]] glm::dvec3 normal() const;
};

/// A point of a surface.
struct SurfacePoint {
  glm::dvec3 position{0.0}, normal{0.0};
  std::uint16_t neighbor = 0;
};

/// The triangles of a surface, in parts whose areas are summed once for several surfaces.
struct SurfaceParts {
  std::vector<std::span<const double>> areaSums;  ///< [parts][triangles] area of triangles 0..i of
                                                  ///< the part
  std::function<SurfaceTriangle(std::size_t part, std::size_t triangle)> triangle;
  std::vector<double> ownSums{};  ///< sums that are kept nowhere else
  /// Displaces a point of a triangle, given by the shares of its corners; null: points stay.
  std::function<void(std::size_t part, std::size_t triangle, const std::array<double, 3>& shares,
                     SurfacePoint& point)>
      displace{};
};

/// Appends the area of a triangle to the sums of its part.
void addArea(std::vector<double>& areaSums, std::size_t firstOfPart, const glm::dvec3& a,
             const glm::dvec3& b, const glm::dvec3& c);

/// The triangles of a surface, numbered over its parts, by cumulative area.  Keeps references to
/// what it is made of.
class SurfaceByArea {
 public:
  /// throws  Error(input) no area
  explicit SurfaceByArea(const TriangleMesh& mesh);
  explicit SurfaceByArea(SurfaceParts parts);
  SurfaceByArea(const SurfaceByArea&) = delete;
  SurfaceByArea& operator=(const SurfaceByArea&) = delete;

  double area() const { return partSums_.back(); }
  std::size_t triangles() const { return ends_.back(); }

  /// Exactly 0 for a degenerate triangle.
  double area(std::size_t triangle) const;

  /// Returns the triangle at a fraction of the area, 0 <= share < 1; its area is above 0.
  std::size_t triangleAt(double share) const;

  [[nodiscard]] SurfaceTriangle at(std::size_t triangle) const {
    const Index index = indexOf(triangle);
    return parts_.triangle(index.part, index.triangle);
  }

  /// Returns a point, see SurfaceTriangle::pointIn, displaced if the parts say so.
  [[nodiscard]] SurfacePoint pointAt(std::size_t triangle, double u, double v) const;

 private:
  struct Index {
    std::size_t part, triangle;
  };

  void addParts();
  Index indexOf(std::size_t triangle) const;

  SurfaceParts parts_;
  std::vector<double> partSums_;   // [parts] area of parts 0..i
  std::vector<std::size_t> ends_;  // [parts] number of triangles in parts 0..i
};

}  // namespace sherd
