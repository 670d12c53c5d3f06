// Charts: the regions of a mesh whose look has no seam.
#pragma once

#include <sherd/appearance.h>
#include <sherd/mesh.h>

#include <array>
#include <cstdint>
#include <vector>

namespace sherd {

/// Two triangles hang together where they share an edge, run along it in opposite directions, have
/// one material, and agree at both its ends on texture coordinates and colours.  A chart is all
/// that hangs together.  It may meet itself at a seam: the texture of a tube is one chart.
struct Charts {
  std::vector<std::uint32_t> of;  ///< [triangles] the lowest triangle of its chart
  std::vector<std::array<std::uint32_t, 3>> beyond;  ///< [triangles] what hangs together with it at
                                                     ///< the edge from each corner to the next, or
                                                     ///< kNoTriangle
  std::vector<std::uint32_t> ownSeam;  ///< triangles at whose edges a chart meets itself, ascending
};
inline constexpr std::uint32_t kNoTriangle = 0xffffffffu;

///   cost    triangles * log(triangles)
[[nodiscard]] Charts charts(const TriangleMesh& mesh, const SurfaceLook& look);

}  // namespace sherd
