// Sets as sorted vectors.
#pragma once

#include <algorithm>
#include <vector>

namespace sherd {

/// Sorts and removes repetitions.
template <class T>
void sortUnique(std::vector<T>& all) {
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
}

}  // namespace sherd
