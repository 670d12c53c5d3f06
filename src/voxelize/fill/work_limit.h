// A limit of work that is counted, not timed, so that it is the same on every machine.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>

namespace sherd {

/// Thrown where a limit of work is exceeded.
struct TooMuchWork {};

/// Counts steps of work of any number of threads.  Whether a limit is exceeded does not depend on
/// their order, if the last of them is followed by a check.
class WorkLimit {
 public:
  static constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

  explicit WorkLimit(std::uint64_t most = kNone) : most_(most) {}

  [[nodiscard]] bool exists() const { return most_ != kNone; }

  /// Returns the steps so far, 0 without a limit.
  [[nodiscard]] std::uint64_t done() const { return done_.load(std::memory_order_relaxed); }

  void add(std::uint64_t steps) {
    if (exists()) done_.fetch_add(steps, std::memory_order_relaxed);
  }

  ///   throws  TooMuchWork
  void check() const {
    if (exists() && done_.load(std::memory_order_relaxed) > most_) throw TooMuchWork();
  }

 private:
  const std::uint64_t most_;
  std::atomic<std::uint64_t> done_{0};
};

}  // namespace sherd
