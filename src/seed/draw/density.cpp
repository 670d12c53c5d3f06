// Where pieces are small: densities in space.
#include "seed/draw/density.h"

#include <sherd/error.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <utility>

#include "base/cancel_flag.h"
#include "mesh/search/nearest_on_triangle.h"
#include "mesh/search/triangle_tree.h"

namespace sherd {
namespace {

constexpr std::uint64_t kBlock = 1024;  // voxels of DenseVoxels

// A surface with values at its vertices.
class ValuedSurface {
 public:
  ValuedSurface(const TriangleMesh& mesh, std::span<const float> values) : tree_(mesh) {
    values_.reserve(mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles)
      values_.push_back({values[t.x], values[t.y], values[t.z]});
  }

  [[nodiscard]] double at(const glm::dvec3& point) const {
    const TriangleTree::Nearest nearest =
        tree_.nearest(point, std::numeric_limits<double>::infinity());
    const std::array<glm::dvec3, 3> t = tree_.corners(nearest.triangle);
    const std::array<float, 3>& values = values_[tree_.source(nearest.triangle)];
    const glm::dvec3 on = nearestOnTriangle(point, t[0], t[1], t[2]);
    double sum = 0.0, area = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double opposite = glm::length(glm::cross(t[(k + 1) % 3] - on, t[(k + 2) % 3] - on));
      sum += opposite * static_cast<double>(values[k]);
      area += opposite;
    }
    return area > 0.0 ? sum / area : static_cast<double>(values[0]);
  }

 private:
  TriangleTree tree_;
  std::vector<std::array<float, 3>> values_;  // [triangles] of the mesh
};

}  // namespace

std::shared_ptr<const DensityField> surfaceDensity(const TriangleMesh& mesh,
                                                   std::span<const float> values) {
  float most = 0.0f;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] >= 0.0f && std::isfinite(values[i]))) {
      throw Error(ErrorCode::input, "the density of vertex " + std::to_string(i) + " is " +
                                        std::to_string(values[i]) +
                                        "; it must be 0 or more, and finite");
    }
    most = std::max(most, values[i]);
  }
  if (most == 0.0f) throw Error(ErrorCode::input, "the density is 0 at all vertices");
  // Rounding could exceed the largest value by a few units in the last place.
  const auto limit = static_cast<double>(most);
  return std::make_shared<const DensityField>(
      [surface = std::make_shared<const ValuedSurface>(mesh, values), limit](const glm::dvec3& at) {
        return std::min(surface->at(at), limit);
      },
      limit);
}

DenseVoxels::DenseVoxels(const VoxelIndex& voxels, const DensityTest& density,
                         const Progress* progress)
    : voxels_(voxels), density_(density), progress_(progress) {
  const std::uint64_t blocks = (voxels.total() + kBlock - 1) / kBlock;
  before_.assign(blocks + 1, 0.0);
  CancelFlag cancelled(progress);
  tbb::parallel_for(std::uint64_t{0}, blocks, [&](std::uint64_t block) {
    if (cancelled.isSet()) return;
    const std::uint64_t end = std::min((block + 1) * kBlock, voxels.total());
    for (std::uint64_t i = block * kBlock; i < end; ++i) before_[block + 1] += at(i);
  });
  cancelled.throwIfSet();
  for (std::uint64_t block = 0; block < blocks; ++block) before_[block + 1] += before_[block];
}

VoxelKey DenseVoxels::draw(double unit, const std::function<bool(VoxelKey)>& isFree) const {
  const std::uint64_t blocks = before_.size() - 1;
  const double target = unit * before_.back();
  const auto found = static_cast<std::uint64_t>(
      std::upper_bound(before_.begin(), before_.end(), target) - before_.begin());
  const std::uint64_t first = std::clamp<std::uint64_t>(found, 1, blocks) - 1;
  double sum = before_[first];
  // The first block is visited again at last, for the voxels before the one drawn.
  for (std::uint64_t k = 0; k <= blocks; ++k) {
    const std::uint64_t block = (first + k) % blocks;
    throwIfCancelled(progress_);
    if (before_[block + 1] == before_[block]) continue;
    const std::uint64_t end = std::min((block + 1) * kBlock, voxels_.total());
    for (std::uint64_t i = block * kBlock; i < end; ++i) {
      const double own = at(i);
      sum += k == 0 ? own : 0.0;
      const bool isAfter = k > 0 || sum > target;
      if (own > 0.0 && isAfter && isFree(voxels_.at(i))) return voxels_.at(i);
    }
  }
  throw Error(ErrorCode::usage,
              "the density is above 0 in fewer voxels than there are seeds; try fewer pieces, or a "
              "higher resolution",
              OptionNames{"pieces", "resolution", "density-attribute"});
}

}  // namespace sherd
