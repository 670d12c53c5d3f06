// Moves vertices of cracks.
#include "remesh/resample/crack_jitter.h"

#include <vector>

#include "base/random.h"

namespace sherd {

void jitterCracks(TriangleMesh& mesh, const GridFrame& frame, const FragmentKey& key) {
  std::vector<bool> isOnCrack(mesh.vertices.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& corner = mesh.triangles[t];
    for (int k = 0; mesh.neighborOf(t) != 0 && k < 3; ++k) isOnCrack[corner[k]] = true;
  }
  for (std::size_t v = 0; v < isOnCrack.size(); ++v) {
    if (!isOnCrack[v]) continue;
    glm::dvec3 at = inVoxels(frame, mesh.vertices[v]);
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint64_t item = (std::uint64_t{key.fragment} << 34 | v) * 3 + k;
      at[static_cast<int>(k)] +=
          kCrackJitter * (2.0 * randomUnit(key.seed, Stage::crackJitter, item) - 1.0);
    }
    mesh.vertices[v] = frame.worldFromIndex(at);
  }
}

}  // namespace sherd
