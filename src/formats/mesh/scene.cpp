// Fragments as a scene of rigid bodies, in any format.
#include "formats/mesh/scene.h"

#include <algorithm>

#include "formats/mesh/each_contact.h"

namespace sherd {

std::vector<SceneLevel> levelsOf(const FragmentScene& scene) {
  const std::size_t count = scene.parentOfSplit.size() + 1;
  std::vector<std::size_t> depth(count, 0), shownIn(count, 0);
  for (std::size_t split = 1; split < count; ++split) {
    const std::size_t parent = scene.parentOfSplit[split - 1];
    depth[split] = depth[parent] + 1;
    shownIn[split] = depth[split] <= kDeepestLevel ? split : shownIn[parent];
  }
  std::vector<SceneLevel> levels(count);
  for (std::size_t i = 0; i < scene.pieces.size(); ++i) {
    levels[shownIn[scene.pieces[i].split]].pieces.push_back(i);
  }
  for (std::size_t split = count - 1; split > 0; --split) {
    std::vector<std::size_t>& own = levels[split].splits;
    std::reverse(own.begin(), own.end());
    if (!levels[split].empty()) levels[scene.parentOfSplit[split - 1]].splits.push_back(split);
  }
  std::reverse(levels[0].splits.begin(), levels[0].splits.end());
  return levels;
}

std::vector<SceneJoint> jointsOf(const FragmentScene& scene) {
  std::vector<SceneJoint> joints;
  forEachContact(std::span<const ScenePiece>(scene.pieces),
                 [&](std::size_t one, std::size_t other, const Contact& contact) {
                   joints.push_back({one, other, &contact});
                 });
  return joints;
}

}  // namespace sherd
