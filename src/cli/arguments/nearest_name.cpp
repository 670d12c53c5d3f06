// Suggestions for misspelled names.
#include "cli/arguments/nearest_name.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace sherd::cli {
namespace {

// Returns the Levenshtein distance: letters to insert, remove or replace.
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (const char letter : a) {
    std::size_t diagonal = std::exchange(row[0], row[0] + 1);
    for (std::size_t k = 0; k < b.size(); ++k) {
      const std::size_t replaced = diagonal + (b[k] == letter ? 0 : 1);
      diagonal = row[k + 1];
      row[k + 1] = std::min({row[k] + 1, row[k + 1] + 1, replaced});
    }
  }
  return row.back();
}

}  // namespace

std::vector<std::string> nearestNames(const std::string& word,
                                      const std::vector<std::string>& names) {
  const auto distance = [&](const std::string& name) {
    return word.size() >= 3 && name.starts_with(word) ? 0 : editDistance(word, name);
  };
  std::size_t least = std::max<std::size_t>(2, word.size() / 3);
  for (const std::string& name : names) least = std::min(least, distance(name));
  std::vector<std::string> nearest;
  for (const std::string& name : names) {
    if (distance(name) == least) nearest.push_back(name);
  }
  return nearest;
}

std::string quotedList(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i == 0 ? "'" : i + 1 < names.size() ? ", '" : " and '") + names[i] + "'";
  }
  return text;
}

}  // namespace sherd::cli
