// Heights of a crack over its plane, and their correlation along a direction.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mesh/plane_moments.h"

namespace sherd {

/// Heights on a square grid in a plane, with u as first axis.
struct HeightGrid {
  int across = 0;               ///< nodes along u
  int down = 0;                 ///< nodes along v
  double spacing = 1.0;         ///< of the nodes, world units, > 0
  std::vector<float> height{};  ///< [down * across] u fastest, world units; NaN where there is none

  [[nodiscard]] float at(int u, int v) const {
    return height[static_cast<std::size_t>(v) * static_cast<std::size_t>(across) +
                  static_cast<std::size_t>(u)];
  }
};

/// Returns the heights of triangles over a plane; where a surface overhangs, the greatest.  Nothing
/// if there would be more than 2^26 nodes.
///   triangles  of the mesh
///   u          unit, in the plane
[[nodiscard]] std::optional<HeightGrid> heightsOver(const TriangleMesh& mesh,
                                                    std::span<const std::uint32_t> triangles,
                                                    const FittedPlane& plane, const glm::dvec3& u,
                                                    double spacing);

/// The correlation sqrt <(h(x + lag) - h(x))^2> along u.
struct Correlation {
  std::vector<double> lags{};     ///< world units, ascending, by a factor of sqrt 2
  std::vector<double> values{};   ///< [lags] world units
  std::optional<double> slope{};  ///< in log-log axes, over lags from 4 nodes to a tenth of the
                                  ///< grid's length, if there are four
};

/// Lags are at most a quarter of the length, and those at which a twentieth of the nodes are pairs.
[[nodiscard]] Correlation correlationAlong(const HeightGrid& grid);

}  // namespace sherd
