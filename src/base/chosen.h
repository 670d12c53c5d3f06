// Selection of array elements.
#pragma once

#include <cstdint>
#include <vector>

namespace sherd {

/// Returns all[which[0]], all[which[1]], ...; empty if `all` is, as absent surface attributes are.
template <class Value>
std::vector<Value> chosen(const std::vector<Value>& all, const std::vector<std::uint32_t>& which) {
  std::vector<Value> some;
  if (all.empty()) return some;
  some.reserve(which.size());
  for (const std::uint32_t i : which) some.push_back(all[i]);
  return some;
}

}  // namespace sherd
