// Progress of a part of a stage.
#pragma once

#include <sherd/progress.h>

namespace sherd {

/// Returns callbacks that map fractions 0..1 to from..to of a stage.
///   progress  null, or exists as long as the result
[[nodiscard]] inline Progress partOf(const Progress* progress, double from, double to) {
  Progress part;
  if (progress != nullptr) part.cancelled = progress->cancelled;
  if (progress != nullptr && progress->report) {
    part.report = [progress, from, to](std::string_view stage, double fraction) {
      progress->report(stage, from + (to - from) * fraction);
    };
  }
  return part;
}

}  // namespace sherd
