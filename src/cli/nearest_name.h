// What somebody may have meant.
#pragma once

#include <string>
#include <vector>

namespace sherd::cli {

/// The names that differ least from a word, if they differ little or begin with it.
[[nodiscard]] std::vector<std::string> nearestNames(const std::string& word,
                                                    const std::vector<std::string>& names);

/// "'a'", "'a' and 'b'", "'a', 'b' and 'c'".
[[nodiscard]] std::string quotedList(const std::vector<std::string>& names);

}  // namespace sherd::cli
