// The faces of the input on which the faces of fragments lie.
#include "appearance/source_faces.h"

#include <tbb/parallel_for.h>

#include "voxelize/region.h"

namespace sherd {

std::vector<std::int32_t> sourceFaces(const TriangleMesh& mesh, const SourceMesh& source,
                                      const AttributeSource& triangles, const Solid& solid) {
  const std::vector<std::uint32_t> found = triangles.trianglesOf(mesh);
  // The triangles of an exact surface have their sources.
  const SolidRegion* const region = mesh.source.empty() ? solid.region.get() : nullptr;
  std::vector<std::int32_t> out(found.size(), kNoSourceFace);
  tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t t) {
    if (found[t] == TriangleMesh::kNoSource) return;
    const glm::uvec3& corner = mesh.triangles[t];
    const glm::dvec3 centroid =
        (mesh.vertices[corner.x] + mesh.vertices[corner.y] + mesh.vertices[corner.z]) / 3.0;
    if (region && region->isAtClosedHole(solid.frame.indexFromWorld(centroid))) return;
    out[t] = static_cast<std::int32_t>(source.polygons.empty() ? found[t]
                                                               : source.polygons[found[t]].polygon);
  });
  return out;
}

}  // namespace sherd
