// The fragment that a point away from all voxels belongs to.
#include "cut/nearest_label.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace sherd {

std::uint16_t nearestLabel(const Labels& labels, const glm::dvec3& index) {
  double least = std::numeric_limits<double>::infinity();
  std::uint16_t nearest = 0;
  for (std::size_t leaf = 0; leaf < labels.blocks->count(); ++leaf) {
    const openvdb::Coord& origin = labels.blocks->origins[leaf];
    const glm::dvec3 low(origin.x(), origin.y(), origin.z());
    const glm::dvec3 apart = index - glm::clamp(index, low, low + 7.0);
    if (glm::dot(apart, apart) >= least) continue;
    for (std::size_t v = 0; v < 512; ++v) {
      const std::uint16_t label = labels.fragment[leaf * 512 + v];
      if (label == 0 || label == Labels::kEroded) continue;
      const openvdb::Coord at = labels.blocks->voxelAt(leaf * 512 + v);
      const glm::dvec3 to = glm::dvec3(at.x(), at.y(), at.z()) - index;
      if (glm::dot(to, to) >= least) continue;
      least = glm::dot(to, to);
      nearest = label;
    }
  }
  return nearest;
}

}  // namespace sherd
