// Finds what depends on a collapse by the changes of its faces.
#include "remesh/collapse_log.h"

#include <algorithm>

#include "base/sort_unique.h"

namespace sherd {

void CollapseLog::add(std::span<const std::uint32_t> changed, std::span<const ComplexFace> faces) {
  const auto collapse = static_cast<std::uint32_t>(first_.size());
  first_.push_back(static_cast<std::uint32_t>(changes_.size()));
  for (const std::uint32_t face : changed) {
    changes_.push_back({collapse, face, last_[face], faces[face].corner});
    last_[face] = static_cast<std::uint32_t>(changes_.size() - 1);
  }
}

std::span<const CollapseLog::Change> CollapseLog::changesOf(std::uint32_t collapse) const {
  const std::size_t end = collapse + 1 < first_.size() ? first_[collapse + 1] : changes_.size();
  return std::span(changes_).subspan(first_[collapse], end - first_[collapse]);
}

std::vector<std::uint32_t> CollapseLog::collapsesToUndo(std::span<const std::uint32_t> of,
                                                        std::size_t depth) const {
  std::vector<std::uint32_t> found;
  std::vector<bool> isFound(first_.size(), false);
  const auto add = [&](std::uint32_t change) {
    const std::uint32_t collapse = changes_[change].collapse;
    if (!isFound[collapse]) found.push_back(collapse);
    isFound[collapse] = true;
  };
  for (const std::uint32_t face : of) {
    std::uint32_t change = last_[face];
    for (std::size_t i = 0; i < depth && change != kNone; ++i, change = changes_[change].before)
      add(change);
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (const Change& change : changesOf(found[i])) {
      const auto own = static_cast<std::uint32_t>(&change - changes_.data());
      for (std::uint32_t later = last_[change.face]; later != own; later = changes_[later].before)
        add(later);
    }
  }
  std::sort(found.rbegin(), found.rend());
  return found;
}

std::vector<std::uint32_t> CollapseLog::undo(std::span<const std::uint32_t> of, std::size_t depth,
                                             std::vector<ComplexFace>& faces) {
  std::vector<std::uint32_t> restored;
  for (const std::uint32_t collapse : collapsesToUndo(of, depth)) {
    for (const Change& change : changesOf(collapse)) {
      faces[change.face].corner = change.corner;
      last_[change.face] = change.before;
      restored.push_back(change.face);
    }
  }
  sortUnique(restored);
  return restored;
}

}  // namespace sherd
