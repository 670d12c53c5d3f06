// The parts of a dataset for training, validation and tests.
#pragma once

#include <sherd/dataset.h>

#include <array>
#include <string>

namespace sherd {

inline constexpr std::array kSplits{"train", "val", "test"};

/// Returns the subset of an object: "train", "val" or "test".  It depends on the key and the shares
/// only, so adding objects moves none.
[[nodiscard]] std::string splitOf(const std::string& key, const std::array<int, 3>& shares);

/// The same of a library's object; of an assemblage that of its objects, which have one.
[[nodiscard]] std::string splitOf(const LibraryObject& object, const std::array<int, 3>& shares);

}  // namespace sherd
