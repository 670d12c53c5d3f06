// The last check of sampled points.
#include "points/check_points.h"

#include "base/finite.h"
#include "surface/check_finite.h"

namespace sherd {

SurfacePoints checkedPoints(SurfacePoints points, int fragment) {
  if (!areFinite(points.positions)) throw notFinite(fragment, "a point", "points");
  if (!areFinite(points.normals)) throw notFinite(fragment, "the normal of a point", "points");
  return points;
}

}  // namespace sherd
