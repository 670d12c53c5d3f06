// Densities of a grid.
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <sherd/error.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/cancel_flag.h"
#include "seed/draw/density.h"

namespace sherd {

std::shared_ptr<const DensityField> gridDensity(std::shared_ptr<const openvdb::FloatGrid> grid,
                                                const Progress* progress) {
  float most = 0.0f;
  const auto take = [&](float value) {
    if (!(value >= 0.0f && std::isfinite(value))) {
      throw Error(ErrorCode::input, "a density of its grid is " + std::to_string(value) +
                                        "; it must be 0 or more, and finite");
    }
    most = std::max(most, value);
  };
  take(grid->background());
  std::size_t visited = 0;
  constexpr std::size_t kAtATime = 1 << 16;
  for (auto value = grid->cbeginValueAll(); value; ++value) {
    if (++visited % kAtATime == 0) throwIfCancelled(progress);
    take(*value);
  }
  if (most == 0.0f) throw Error(ErrorCode::input, "the density of its grid is 0 everywhere");
  const auto limit = static_cast<double>(most);
  return std::make_shared<const DensityField>(
      [grid = std::move(grid), limit](const glm::dvec3& at) {
        const auto values = grid->getConstAccessor();
        openvdb::Vec3d index = grid->worldToIndex({at.x, at.y, at.z});
        constexpr double kFarthest = 1
                                     << 30;  // no grid has voxels there, and numbers fit in 32 bits
        for (int axis = 0; axis < 3; ++axis) {
          index[axis] = std::clamp(index[axis], -kFarthest, kFarthest);
        }
        const auto value = static_cast<double>(openvdb::tools::BoxSampler::sample(values, index));
        return std::clamp(value, 0.0, limit);
      },
      limit);
}

}  // namespace sherd
