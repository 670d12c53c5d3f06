// All fragments of a labelled solid, and the unbroken solid as they are.
#include <sherd/fragments.h>

#include <utility>

#include "surface/cut.h"
#include "surface/extraction.h"
#include "surface/interface_mesh.h"
#include "surface/mesh.h"

namespace sherd {

std::vector<Fragment> extractFragments(const Solid& solid, const Labels& labels, int count,
                                       const Labels* unworn, const SurfaceOptions& surface,
                                       const Progress* progress, const UnbrokenSurface* unbroken) {
  Extraction extraction(solid, labels, count, unworn, surface, progress, unbroken);
  std::vector<Fragment> all;
  for (std::vector<Fragment> some = extraction.next(); !some.empty(); some = extraction.next()) {
    std::move(some.begin(), some.end(), std::back_inserter(all));
  }
  std::vector<std::vector<Contact>> contacts = extraction.contacts();
  for (std::size_t i = 0; i < all.size(); ++i) all[i].contacts = std::move(contacts[i]);
  return all;
}

TriangleMesh solidMesh(const Solid& solid, const SurfaceOptions& options) {
  if (options.interface == Interface::shared) {
    Labels one;
    one.fragment.assign(solid.blocks.count() * 512, 1);
    Cut uncut;
    uncut.only.assign(solid.blocks.count(), 1);
    uncut.index.assign(solid.blocks.count(), Cut::kWhole);
    uncut.stairs.resize(2);
    const std::vector<LeafRound> rounds = leavesRound(solid.blocks.origins);
    return std::move(InterfaceMeshes(solid, one, uncut, rounds, 1).meshOf(1).mesh);
  }
  return meshLevelSet(*solid.distance, solid.frame, nullptr).mesh;
}

}  // namespace sherd
