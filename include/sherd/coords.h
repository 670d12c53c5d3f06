// Points that know their space.
#pragma once

#include <glm/vec3.hpp>

namespace sherd {

/// A point of one space.  Meshes hold bare vectors, which convert to a point of either space and
/// from it; a point of one space does not convert to one of another, so that a conversion that is
/// done twice does not compile.  Sums and products of points are bare vectors.
template <class Space>
struct Point : glm::dvec3 {
  Point() : glm::dvec3(0.0) {}
  Point(const glm::dvec3& bare) : glm::dvec3(bare) {}
  Point(double i, double j, double k) : glm::dvec3(i, j, k) {}
  template <class Other>
  Point(const Point<Other>&) = delete;
};

using WorldPoint = Point<struct WorldSpace>;  ///< the mesh's own length unit
using IndexPoint = Point<struct IndexSpace>;  ///< voxels; their centers are at whole numbers

}  // namespace sherd
