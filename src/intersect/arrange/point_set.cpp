// Points numbered by their exact positions.
#include "intersect/arrange/point_set.h"

#include <bit>

#include "base/random.h"
#include "intersect/homogeneous_point.h"

namespace sherd {

std::size_t PointSet::Hash::operator()(const glm::dvec3& p) const {
  std::uint64_t hash = 0;
  // + 0.0: both zeros are one number.
  for (int k = 0; k < 3; ++k) hash = mixed(hash ^ std::bit_cast<std::uint64_t>(p[k] + 0.0));
  return hash;
}

void PointSet::addVertex(std::uint32_t vertex) {
  std::vector<std::uint32_t>& own = numbers_[vertices_[vertex]];
  if (own.empty()) own.push_back(vertex);
}

std::uint32_t PointSet::add(const ExactPoint& point) {
  std::vector<std::uint32_t>& own = numbers_[point.rounded];
  for (const std::uint32_t number : own) {
    if (areEqual(at(number), point)) return number;
  }
  const auto number = static_cast<std::uint32_t>(count());
  points_.push_back(point);
  own.push_back(number);
  return number;
}

}  // namespace sherd
