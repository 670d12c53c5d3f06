// Charts: the regions of a mesh whose surface attributes have no seam.
#pragma once

#include <sherd/mesh.h>

#include <array>
#include <cstdint>
#include <vector>

namespace sherd {

/// Two triangles are connected if they share an edge in opposite directions, have the same
/// material, and have the same texture coordinates and colors at both ends of the edge.  A chart is
/// a connected component of triangles.  It may meet itself at a seam: the texture of a tube is one
/// chart.
struct Charts {
  /// An edge of two triangles whose attributes differ there.
  struct Seam {
    std::array<std::uint32_t, 2> triangle{};
    std::array<std::uint8_t, 2> corner{};  ///< of each, from which the edge goes to the next
  };

  std::vector<std::uint32_t> ids;  ///< [triangles] the chart, as its lowest triangle
  /// [triangles] the triangle connected over the edge from each corner to the next, or kNoTriangle
  std::vector<std::array<std::uint32_t, 3>> neighbors;
  std::vector<std::uint32_t> selfSeam;  ///< triangles where a chart meets itself, ascending
  std::vector<Seam> seams;  ///< edges where attributes differ, in the order of their vertices
};
inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

/// Finds the charts of a mesh.
///   attributes  of its triangles; each array may be empty
///   cost        triangles * log(triangles)
[[nodiscard]] Charts charts(const TriangleMesh& mesh);

}  // namespace sherd
