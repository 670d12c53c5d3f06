// Suggestions for misspelled names.
#pragma once

#include <string>
#include <vector>

namespace sherd::cli {

/// Returns the names with the least edit distance to a word, if it is at most 2 or a third of the
/// word's length, or the word is a prefix of at least 3 letters.
[[nodiscard]] std::vector<std::string> nearestNames(const std::string& word,
                                                    const std::vector<std::string>& names);

/// Returns "'a'", "'a' and 'b'", "'a', 'b' and 'c'".
[[nodiscard]] std::string quotedList(const std::vector<std::string>& names);

}  // namespace sherd::cli
