// The fragment that a point away from all voxels belongs to.
#pragma once

#include <sherd/labels.h>

#include <cstdint>
#include <glm/vec3.hpp>

namespace sherd {

/// Returns the label of the voxel that is nearest to a point in index space; 0 if there are none.
[[nodiscard]] std::uint16_t nearestLabel(const Labels& labels, const glm::dvec3& index);

}  // namespace sherd
