// Boxes in a tree.
#include "mesh/search/near_boxes.h"

#include <algorithm>

namespace sherd {
namespace {

TriangleMesh diagonalsOf(std::span<const Box> boxes) {
  TriangleMesh diagonals;
  for (const Box& box : boxes) {
    const auto low = static_cast<std::uint32_t>(diagonals.vertices.size());
    diagonals.vertices.insert(diagonals.vertices.end(), {box.min, box.max});
    diagonals.triangles.emplace_back(low, low + 1, low + 1);
  }
  return diagonals;
}

}  // namespace

BoxTree::BoxTree(std::span<const Box> boxes) : tree_(diagonalsOf(boxes)) {}

std::vector<std::uint32_t> BoxTree::meeting(const Box& box) const {
  std::vector<std::uint32_t> found;
  for (const std::uint32_t i : tree_.meeting(box)) found.push_back(tree_.source(i));
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::uint8_t> meetingOthers(std::span<const Box> boxes) {
  const BoxTree tree(boxes);
  std::vector<std::uint8_t> isMeeting(boxes.size(), 0);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (isMeeting[i] != 0) continue;
    for (const std::uint32_t other : tree.meeting(boxes[i])) {
      if (other != i) isMeeting[i] = isMeeting[other] = 1;
    }
  }
  return isMeeting;
}

}  // namespace sherd
