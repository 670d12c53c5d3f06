// Cuts a solid.
#include "interface/cut_solid.h"

#include <utility>

namespace sherd {
namespace {

std::shared_ptr<const IntactSurface> fittingIntact(std::shared_ptr<const IntactSurface> intact,
                                                   const Solid& solid) {
  checkIntact(intact.get(), solid);
  return intact;
}

}  // namespace

CutSolid::CutSolid(const Solid& solid, const Labels& labels,
                   std::shared_ptr<const IntactSurface> intact, CutExtent extent,
                   const Progress* progress)
    : intact_(fittingIntact(std::move(intact), solid)),
      ownNeighborhoods_(intact_ ? std::vector<LeafNeighbors>()
                                : leafNeighbors(solid.blocks->origins)),
      cut_(findCut(labels, neighborhoods(), extent, progress)) {}

void CutSolid::findCreases(const Solid& solid, const Progress* progress) {
  if (!intact_) ownCreases_ = Creases(solid, ownNeighborhoods_, progress);
}

}  // namespace sherd
