// Samples points on the faces that two fragments share.
#include <sherd/points.h>

#include "base/random.h"
#include "points/check_points.h"

namespace sherd {

Correspondences sampleCorrespondences(std::span<const Fragment> fragments,
                                      std::size_t countPerContact, std::uint64_t seed) {
  Correspondences found;
  for (const Fragment& fragment : fragments) {
    for (const Contact& contact : fragment.contacts) {
      if (contact.fragment < fragment.id || contact.fragment > static_cast<int>(fragments.size())) {
        continue;
      }
      TriangleMesh shared{fragment.mesh.vertices, {}};
      for (std::size_t t = 0; t < fragment.mesh.neighbor.size(); ++t) {
        if (fragment.mesh.neighbor[t] == contact.fragment) {
          shared.triangles.push_back(fragment.mesh.triangles[t]);
        }
      }
      if (area(shared) == 0.0) continue;
      const auto item = static_cast<std::uint64_t>(fragment.id) << 16 |
                        static_cast<std::uint64_t>(contact.fragment);
      const SurfacePoints points =
          checkedPoints(samplePoints(shared, {.count = countPerContact,
                                              .seed = randomBits(seed, Stage::pointContact, item)}),
                        fragment.id);
      found.positions.insert(found.positions.end(), points.positions.begin(),
                             points.positions.end());
      found.normals.insert(found.normals.end(), points.normals.begin(), points.normals.end());
      found.fragments.insert(found.fragments.end(), points.positions.size(),
                             {fragment.id, contact.fragment});
    }
  }
  return found;
}

}  // namespace sherd
