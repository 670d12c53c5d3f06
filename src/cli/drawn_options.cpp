// Options whose values are drawn at random for each fracture of a dataset.
#include "cli/drawn_options.h"

#include <charconv>
#include <cmath>
#include <utility>

#include "base/number_text.h"
#include "base/random.h"
#include "cli/fracture_options.h"
#include "cli/option_text.h"

namespace sherd::cli {
namespace {

std::optional<std::int64_t> wholeIn(const std::string& text) {
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

// A random stream per name: the value of an option does not depend on which others are drawn.
std::uint64_t itemOf(const std::string& name) {
  std::uint64_t hash = 0;
  for (const char c : name) hash = mixed(hash + static_cast<unsigned char>(c));
  return hash;
}

void parseInto(FractureOptions& options, const std::vector<std::string>& arguments) {
  CLI::App app;
  app.add_option("--pieces");  // --seeds excludes it, so it must exist
  addSeedOptions(app, options);
  addGrowthOptions(app, options);
  addErosionOptions(app, options);
  addSurfaceOptions(app, options);
  std::vector<std::string> reversed(arguments.rbegin(),
                                    arguments.rend());  // CLI11 expects reverse order
  app.parse(std::move(reversed));
}

}  // namespace

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
  const double from = *numberIn(low), to = *numberIn(high);
  // Six digits, so that the index records the exact value.
  char text[32];
  std::snprintf(text, sizeof text, "%.6g",
                from + (to - from) * randomUnit(seed, Stage::datasetOption, item));
  return text;
}

std::optional<DrawnOption> drawnOption(const std::string& name, const std::string& value) {
  if (value.find('|') != std::string::npos) {
    DrawnOption option{name, {}, {}, {}};
    std::size_t begin = 0;
    for (;;) {
      const std::size_t end = value.find('|', begin);
      option.choices.push_back(value.substr(begin, end - begin));
      if (end == std::string::npos) return option;
      begin = end + 1;
    }
  }
  const std::size_t dots = value.find("..");
  if (dots == std::string::npos) return std::nullopt;
  DrawnOption option{name, value.substr(0, dots), value.substr(dots + 2), {}};
  const auto low = numberIn(option.low), high = numberIn(option.high);
  if (!low || !high || *low > *high) return std::nullopt;
  return option;
}

DrawnOptions drawInto(const std::vector<DrawnOption>& drawn, std::uint64_t seed,
                      FractureOptions& options) {
  DrawnOptions values;
  std::vector<std::string> arguments;
  for (const DrawnOption& option : drawn) {
    values.emplace_back(option.name.substr(2), option.valueFor(seed));
    arguments.push_back(option.name + "=" + values.back().second);
  }
  if (!arguments.empty()) parseInto(options, arguments);
  return values;
}

void checkDrawn(const std::vector<DrawnOption>& drawn, const FractureOptions& options) {
  for (const DrawnOption& option : drawn) {
    const std::vector<std::string> ends =
        option.choices.empty() ? std::vector<std::string>{option.low, option.high} : option.choices;
    for (const std::string& end : ends) {
      FractureOptions tried = options;
      parseInto(tried, {option.name + "=" + end});
    }
  }
}

}  // namespace sherd::cli
