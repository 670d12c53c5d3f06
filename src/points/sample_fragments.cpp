// Points on the surfaces of fragments.
#include <sherd/points.h>
#include <tbb/parallel_for.h>

#include "base/cancel_flag.h"
#include "points/check_points.h"
#include "points/sample_surface.h"
#include "surface/fragment_surfaces.h"

namespace sherd {

std::vector<SurfacePoints> samplePoints(const Solid& solid, const Labels& labels,
                                        const FragmentPointOptions& options,
                                        const Progress* progress) {
  checkPointOptions(options.points);
  const FragmentSurfaces surfaces(solid, labels, options.uneroded, options.intact, progress);
  return samplePoints(surfaces, options.points, progress);
}

std::vector<SurfacePoints> samplePoints(const FragmentSurfaces& surfaces,
                                        const PointOptions& options, const Progress* progress) {
  checkPointOptions(options);
  std::vector<SurfacePoints> points(surfaces.count());
  if (options.count == 0) return points;
  CancelFlag stop(progress);
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    if (stop.isSet()) return;
    const auto id = static_cast<std::uint16_t>(i + 1);
    points[i] = samplePoints(surfaces.byArea(id), pointOptionsOf(options, id));
    requireFinite(points[i], id);
  });
  stop.throwIfSet();
  return points;
}

}  // namespace sherd
