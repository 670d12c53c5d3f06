// The last check of sampled points.
#include "points/check_points.h"

#include <utility>

#include "base/finite.h"
#include "surface/check_finite.h"

namespace sherd {

void requireFinite(const SurfacePoints& points, int fragment) {
  if (!areFinite(points.positions)) throw notFinite(fragment, "a point", "points");
  if (!areFinite(points.normals)) throw notFinite(fragment, "the normal of a point", "points");
}

Blocks<SurfacePoints> finite(Blocks<SurfacePoints> points, int fragment) {
  return {points.count, [each = std::move(points.forEach), fragment](const auto& visit) {
            each([&](const SurfacePoints& block) {
              requireFinite(block, fragment);
              visit(block);
            });
          }};
}

}  // namespace sherd
