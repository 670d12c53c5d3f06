// Finds the lowest common ancestor of fragments in the tree of splits.
#include "evaluate/parting_splits.h"

#include <map>
#include <set>

namespace sherd {
namespace {

int splitOf(const FragmentSet& set, int id) {
  // Ids of a manifest are positions in its list
  const auto index = static_cast<std::size_t>(id) - 1;
  return index < set.fragments.size() ? set.fragments[index].split : 0;
}

}  // namespace

std::vector<std::uint32_t> partingSplits(const FragmentSet& set, std::size_t fragment,
                                         std::span<const std::uint16_t> neighbor) {
  const auto parentOf = [&](int split) {
    return set.splitParents[static_cast<std::size_t>(split) - 1];
  };
  std::set<int> own;
  for (int split = set.fragments[fragment].split; split > 0; split = parentOf(split)) {
    own.insert(split);
  }
  const auto splits = static_cast<std::uint32_t>(set.splitParents.size());
  std::map<std::uint16_t, std::uint32_t> known{{std::uint16_t{0}, 0u}};
  std::vector<std::uint32_t> result;
  result.reserve(neighbor.size());
  for (const std::uint16_t id : neighbor) {
    const auto [place, fresh] = known.try_emplace(id, splits + id);
    if (fresh) {
      int split = splitOf(set, id);
      while (split > 0 && !own.contains(split)) split = parentOf(split);
      if (split > 0) place->second = static_cast<std::uint32_t>(split);
    }
    result.push_back(place->second);
  }
  return result;
}

}  // namespace sherd
