// The charts of a fragment's faces, whose borders decimation keeps.
#pragma once

#include <sherd/mesh.h>
#include <sherd/solid.h>

#include <cstdint>
#include <vector>

namespace sherd {

class Seams;

/// Returns a number for the chart of each face of the original surface: near seams that of the
/// input's triangle nearest to its centroid, elsewhere that of the faces around; 0 on cracks, and
/// where no seam is near.  Both sides of a seam where a chart meets itself have the same number.
///   mesh    closed, cut along seams
///   return  [triangles]
[[nodiscard]] std::vector<std::uint32_t> seamCharts(const TriangleMesh& mesh, const Seams& seams,
                                                    const GridFrame& frame);

}  // namespace sherd
