// Progress reports and cancellation of long work.
#pragma once

#include <functional>
#include <string_view>

namespace sherd {

/// Callbacks for functions that may take long.  Both may be empty.  They are called at least once
/// per stage and usually several times a second.
struct Progress {
  /// Called from the thread that called the function.  `fraction` of the stage is 0..1.
  std::function<void(std::string_view stage, double fraction)> report;
  /// Called from any thread, concurrently.  true: the function soon throws Error(cancelled).
  std::function<bool()> cancelled;
};

/// Calls `report`, or throws Error(cancelled) if `cancelled` returns true.  Does nothing if
/// `progress` is null.
void reportProgress(const Progress* progress, std::string_view stage, double fraction);

}  // namespace sherd
