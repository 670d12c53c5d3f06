// Limits the memory that parallel tasks take together.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace sherd {

/// Lets tasks in while their memory together stays below a limit; one that takes more runs alone.
/// A task inside must not wait for other tasks.
class MemoryGate {
 public:
  ///   most  bytes
  explicit MemoryGate(std::uint64_t most) : most_(most) {}

  /// The memory of a task while it exists.
  class Hold {
   public:
    /// Waits until the bytes fit.
    Hold(MemoryGate& gate, std::uint64_t bytes) : gate_(gate), bytes_(bytes) {
      std::unique_lock lock(gate_.mutex_);
      gate_.changed_.wait(lock,
                          [&] { return gate_.held_ == 0 || gate_.held_ + bytes_ <= gate_.most_; });
      gate_.held_ += bytes_;
    }
    ~Hold() {
      {
        const std::lock_guard lock(gate_.mutex_);
        gate_.held_ -= bytes_;
      }
      gate_.changed_.notify_all();
    }
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;

   private:
    MemoryGate& gate_;
    std::uint64_t bytes_;
  };

 private:
  std::uint64_t most_;
  std::uint64_t held_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
};

}  // namespace sherd
