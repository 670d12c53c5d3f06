// Options whose values are drawn at random for each fracture of a dataset.
#include <sherd/error.h>
#include <sherd/options.h>

#include <charconv>
#include <cstdio>

#include "base/random.h"
#include "base/text/option_text.h"

namespace sherd {
namespace {

std::optional<std::int64_t> wholeIn(const std::string& text) {
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

// Returns the text without the sign of a percentage.
std::string withoutPercent(const std::string& text) {
  return text.substr(0, text.size() - (text.ends_with('%') ? 1 : 0));
}

// A random stream per name: the value of an option does not depend on which others are drawn.
std::uint64_t itemOf(const std::string& name) {
  std::uint64_t hash = 0;
  for (const char c : "--" + name) hash = mixed(hash + static_cast<unsigned char>(c));
  return hash;
}

}  // namespace

std::string DrawnOption::text() const {
  return choices.empty() ? low + ".." + high : joinedText(choices, "|");
}

std::string DrawnOption::valueFor(std::uint64_t seed) const {
  const std::uint64_t item = itemOf(name);
  if (!choices.empty()) {
    return choices[randomBelow(choices.size(), seed, Stage::datasetOption, item)];
  }
  const auto first = wholeIn(low), last = wholeIn(high);
  if (first && last) {
    const auto count = static_cast<std::uint64_t>(*last - *first) + 1;
    return std::to_string(
        *first + static_cast<std::int64_t>(randomBelow(count, seed, Stage::datasetOption, item)));
  }
  const double from = *numberIn(withoutPercent(low)), to = *numberIn(withoutPercent(high));
  // Six digits, so that the index records the exact value.
  char text[32];
  std::snprintf(text, sizeof text, "%.6g",
                from + (to - from) * randomUnit(seed, Stage::datasetOption, item));
  return std::string(text) + (low.ends_with('%') ? "%" : "");
}

std::optional<DrawnOption> drawnOption(std::string_view name, const std::string& text) {
  const FractureOptionRow* const row = fractureOption(name);
  if (row == nullptr || !row->drawn) return std::nullopt;
  if (text.find('|') != std::string::npos) {
    return DrawnOption{row->name, {}, {}, split(text, '|')};
  }
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos) return std::nullopt;
  DrawnOption option{row->name, text.substr(0, dots), text.substr(dots + 2), {}};
  const auto low = numberIn(withoutPercent(option.low)),
             high = numberIn(withoutPercent(option.high));
  if (!low || !high || *low > *high) return std::nullopt;
  if (option.low.ends_with('%') != option.high.ends_with('%')) return std::nullopt;
  return option;
}

void checkDrawn(const DrawnOption& drawn, const RunOptions& options) {
  const std::vector<std::string> ends =
      drawn.choices.empty() ? std::vector<std::string>{drawn.low, drawn.high} : drawn.choices;
  for (const std::string& end : ends) {
    RunOptions tried = options;
    fractureOption(drawn.name)->value.set(tried, end);
  }
}

}  // namespace sherd
