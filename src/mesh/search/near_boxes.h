// Boxes that meet others.
#pragma once

#include <sherd/mesh.h>

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/search/triangle_tree.h"

namespace sherd {

/// Boxes in a tree.  Thread-safe.
class BoxTree {
 public:
  explicit BoxTree(std::span<const Box> boxes);

  /// Returns the boxes that have a point in common with one, ascending.
  [[nodiscard]] std::vector<std::uint32_t> meeting(const Box& box) const;

 private:
  TriangleTree tree_;  // of diagonals, triangles without area whose boxes these are
};

/// Returns [boxes] 1 for those that have a point in common with another, else 0.
///   cost  boxes * log(boxes), where few boxes meet many
[[nodiscard]] std::vector<std::uint8_t> meetingOthers(std::span<const Box> boxes);

}  // namespace sherd
