// The parts of a dataset for training, validation and tests.
#pragma once

#include <array>
#include <string>

namespace sherd {

/// Returns the subset of an object: "train", "val" or "test".  It depends on the key and the shares
/// only, so adding objects moves none.
[[nodiscard]] std::string splitOf(const std::string& key, const std::array<int, 3>& shares);

}  // namespace sherd
