// Boxes that meet others, by a tree.
#include "mesh/near_boxes.h"

#include "mesh/triangle_tree.h"

namespace sherd {

std::vector<std::uint8_t> meetingOthers(std::span<const Box> boxes) {
  TriangleMesh diagonals;  // triangles without area, whose boxes these are
  for (const Box& box : boxes) {
    const auto low = static_cast<std::uint32_t>(diagonals.vertices.size());
    diagonals.vertices.insert(diagonals.vertices.end(), {box.min, box.max});
    diagonals.triangles.emplace_back(low, low + 1, low + 1);
  }
  const TriangleTree tree(diagonals);
  std::vector<std::uint8_t> isMeeting(boxes.size(), 0);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (isMeeting[i] != 0) continue;
    for (const std::uint32_t other : tree.meeting(boxes[i])) {
      if (tree.source(other) != i) isMeeting[i] = isMeeting[tree.source(other)] = 1;
    }
  }
  return isMeeting;
}

}  // namespace sherd
