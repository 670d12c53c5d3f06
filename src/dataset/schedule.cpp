// The fractures of an object and their seeds.
#include <sherd/dataset.h>

#include <charconv>

#include "base/random.h"

namespace sherd {

std::vector<PlannedFracture> fracturesOf(const Schedule& schedule) {
  std::vector<PlannedFracture> planned;
  std::size_t fragments = 0;
  const int steps = std::max(schedule.most - schedule.fewest, 1);
  for (int pieces = schedule.fewest; pieces <= schedule.most; ++pieces) {
    const int change = schedule.repeatsOfMost - schedule.repeatsOfFewest;
    // Both terms are whole and their sum is not negative, so this truncates.
    const int repeats =
        (schedule.repeatsOfFewest * steps + change * (pieces - schedule.fewest)) / steps;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      fragments += static_cast<std::size_t>(pieces);
      if (fragments > schedule.maxFragments) return planned;
      planned.push_back({pieces, repeat});
    }
  }
  return planned;
}

std::uint64_t fractureSeed(std::uint64_t runSeed, const std::string& sha256,
                           const PlannedFracture& fracture, int attempt) {
  std::uint64_t content = 0;
  std::from_chars(sha256.data(), sha256.data() + std::min<std::size_t>(16, sha256.size()), content,
                  16);
  const auto item = static_cast<std::uint64_t>(fracture.pieces) << 40 |
                    static_cast<std::uint64_t>(fracture.repeat) << 16 |
                    static_cast<std::uint64_t>(attempt);
  return randomBits(randomBits(runSeed, Stage::datasetObject, content), Stage::datasetFracture,
                    item);
}

}  // namespace sherd
