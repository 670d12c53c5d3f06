// The parts of a dataset.
#include "dataset/layouts/split_of.h"

#include <algorithm>

#include "base/files/sha256.h"

namespace sherd {

std::string splitOf(const std::string& key, const std::array<int, 3>& shares) {
  const int all = shares[0] + shares[1] + shares[2];
  const std::string sum = sha256(key);
  const auto bucket = static_cast<int>(std::stoul(sum.substr(0, 7), nullptr, 16) %
                                       static_cast<unsigned long>(std::max(all, 1)));
  if (bucket < shares[0]) return "train";
  return bucket < shares[0] + shares[1] ? "val" : "test";
}

std::string splitOf(const LibraryObject& object, const std::array<int, 3>& shares) {
  return splitOf(object.parts.empty() ? object.key : object.parts.front().key, shares);
}

}  // namespace sherd
