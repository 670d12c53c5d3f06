// Points numbered by their exact positions.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <unordered_map>
#include <vector>

#include "intersect/crossing_point.h"

namespace sherd {

/// The vertices of a mesh, and new points after them: one number for each exact position.
class PointSet {
 public:
  ///   vertices  of different positions; not copied
  explicit PointSet(std::span<const glm::dvec3> vertices) : vertices_(vertices) {}

  /// Makes a vertex known, so that points added at its position get its number.
  void addVertex(std::uint32_t vertex);

  /// Returns the number of a point's position.
  std::uint32_t add(const ExactPoint& point);

  [[nodiscard]] ExactPoint at(std::uint32_t number) const {
    return number < vertices_.size() ? ExactPoint(vertices_[number])
                                     : points_[number - vertices_.size()];
  }
  [[nodiscard]] const glm::dvec3& rounded(std::uint32_t number) const {
    return number < vertices_.size() ? vertices_[number]
                                     : points_[number - vertices_.size()].rounded;
  }
  [[nodiscard]] std::size_t count() const { return vertices_.size() + points_.size(); }

 private:
  struct Hash {
    std::size_t operator()(const glm::dvec3& p) const;
  };

  std::span<const glm::dvec3> vertices_;
  std::vector<ExactPoint> points_;
  std::unordered_map<glm::dvec3, std::vector<std::uint32_t>, Hash> numbers_;  // by rounded
};

}  // namespace sherd
