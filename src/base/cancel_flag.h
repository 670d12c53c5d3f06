// Cancellation of work on several threads.
#pragma once

#include <sherd/error.h>
#include <sherd/progress.h>

#include <atomic>

namespace sherd {

[[nodiscard]] inline bool isCancelled(const Progress* progress) {
  return progress != nullptr && progress->cancelled && progress->cancelled();
}

/// Throws Error(cancelled) if `cancelled` returns true.  Loops within a stage call this every few
/// milliseconds.
inline void throwIfCancelled(const Progress* progress) {
  if (isCancelled(progress)) {
    throw Error(ErrorCode::cancelled, "stopped on request");
  }
}

/// Polls for cancellation from any thread.  Tasks return early once it is set, and the thread that
/// started them throws.
class CancelFlag {
 public:
  explicit CancelFlag(const Progress* progress) : progress_(progress) {}

  [[nodiscard]] bool isSet() {
    if (!set_ && isCancelled(progress_)) set_ = true;
    return set_;
  }

  ///   throws  Error(cancelled)
  void throwIfSet() const {
    if (set_) throw Error(ErrorCode::cancelled, "stopped on request");
  }

 private:
  const Progress* progress_;
  std::atomic<bool> set_{false};
};

}  // namespace sherd
