// What a fracture that is broken again takes from the earlier one's manifest.
#pragma once

#include <sherd/fracture.h>

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace sherd {

/// The most earlier breaks that a manifest has: the first, and the latest.
inline constexpr std::size_t kMostHistory = 64;

/// The most bytes of an earlier break's options; of larger ones only the seed is kept.
inline constexpr std::size_t kLargestHistoryOptions = 64 << 10;

/// Returns the history of what breaks a fracture again: that of the fracture's manifest, and its
/// own break, each as the text of a JSON object.
///   manifest  untrusted; what is no history is left out
[[nodiscard]] BreakHistory historyAfter(const nlohmann::json& manifest);

}  // namespace sherd
