// The grid of the voxels that meshes were made on, as their vertices have it.
#pragma once

#include <sherd/evaluate.h>

#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "evaluate/cracks/fragment_shape.h"

namespace sherd {

/// Points of which powers are measured, in single precision, pitches about their mean.
struct GridPoints {
  std::vector<float> x{}, y{}, z{};

  void add(const glm::dvec3& p);
  [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// Returns |mean exp(2 pi i x.d)|^2 times the number of points for each direction d: 1 in the mean
/// for points at random, their number for those on planes one pitch apart across d.
///   points  at most 1e4 pitches from the origin, so that phases are good to 0.001
[[nodiscard]] std::vector<double> powersAlong(const GridPoints& points,
                                              std::span<const glm::dvec3> directions);

/// Measures vertices of cracks that no triangle of the original surface has, of at most 24
/// fragments with at least 100 of these.  Nothing without any.
///   pitch   of the grid, world units; 0: not known, the one of greatest power beside random
///           directions is taken, from a third of a median edge to three
///   throws  Error(cancelled)
[[nodiscard]] std::optional<GridTrace> gridTraceOf(std::span<const DividedMesh> meshes,
                                                   double pitch, const Progress* progress);

}  // namespace sherd
