// How long work tells how far it is, and is asked to stop.
#pragma once

#include <functional>
#include <string_view>

namespace sherd {

/// Given to functions that may take long.  Both members may be empty.  They are called at least
/// once per stage and usually several times a second.
struct Progress {
  /// From the thread that called the function.  fraction of the stage, 0..1
  std::function<void(std::string_view stage, double fraction)> report;
  /// From any thread, several at once.  true: stop soon by throwing Error(cancelled)
  std::function<bool()> cancelled;
};

/// Report and, if the caller wants to stop, throw Error(cancelled).  Nothing happens when
/// `progress` is null.
void step(const Progress* progress, std::string_view stage, double fraction);

}  // namespace sherd
