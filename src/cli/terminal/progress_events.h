// Progress for programs: JSON on standard error, an object a line.
#pragma once

#include <chrono>
#include <set>
#include <string>
#include <string_view>

#include "cli/terminal/overall_progress.h"

namespace sherd::cli {

/// Prints {"stage": "voxelize", "fraction": 0.3, "overall": 0.132}, at most ten lines a second
/// beside the first of each stage.  A line is left out where nobody reads: printing neither fails
/// nor waits.
class ProgressEvents {
 public:
  ///   shown  false: prints nothing
  ProgressEvents(bool shown, bool isExact) : shown_(shown), overall_(isExact) {}

  [[nodiscard]] OverallProgress& overall() { return overall_; }

  /// Called by one thread.
  void show(std::string_view stage, double fraction);

  /// Prints the last line: the stage "done", of which all is done.
  void finish();

 private:
  bool shown_;
  OverallProgress overall_;
  std::set<std::string, std::less<>> begun_;  // stages
  std::chrono::steady_clock::time_point last_;
};

}  // namespace sherd::cli
