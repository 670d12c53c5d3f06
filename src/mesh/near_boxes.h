// Boxes that meet others.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sherd {

/// Returns [boxes] 1 for those that have a point in common with another, else 0.
///   cost  boxes * log(boxes), where few boxes meet many
[[nodiscard]] std::vector<std::uint8_t> meetingOthers(std::span<const Box> boxes);

}  // namespace sherd
