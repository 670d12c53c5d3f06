// The memory budget for reading a file.
#pragma once

#include <sherd/error.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

namespace sherd {

/// Returns "3 GB", by three digits.
[[nodiscard]] inline std::string gigabytes(std::uint64_t bytes) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g GB", static_cast<double>(bytes) / 1e9);
  return text;
}

/// Counts the bytes for reading one file before they are allocated, so that a small malicious file
/// cannot exhaust the memory.  For one thread.
class MemoryBudget {
 public:
  ///   file   name for the message
  ///   limit  bytes
  MemoryBudget(std::string file, std::uint64_t limit) : file_(std::move(file)), limit_(limit) {}

  ///   throws  Error(input) the sum would be above the limit
  void charge(std::uint64_t count, std::uint64_t bytesEach = 1) {
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
    const bool fits = bytesEach == 0 || count <= (kMost - taken_) / bytesEach;
    const std::uint64_t sum = fits ? taken_ + count * bytesEach : kMost;
    if (sum > limit_) {
      throw Error(ErrorCode::input,
                  file_ + ": reading it takes " + gigabytes(sum) + " of memory or more, and " +
                      gigabytes(limit_) + " may be used",
                  OptionNames{"max-memory"});
    }
    taken_ = sum;
  }
  void release(std::uint64_t bytes) { taken_ -= std::min(bytes, taken_); }

  [[nodiscard]] std::uint64_t taken() const { return taken_; }
  [[nodiscard]] std::uint64_t left() const { return limit_ - taken_; }

 private:
  std::string file_;
  std::uint64_t limit_, taken_ = 0;
};

/// The destructor releases what was charged since the constructor.
class TransientMemory {
 public:
  ///   memory  may be null
  explicit TransientMemory(MemoryBudget* memory)
      : memory_(memory), before_(memory != nullptr ? memory->taken() : 0) {}
  TransientMemory(const TransientMemory&) = delete;
  TransientMemory& operator=(const TransientMemory&) = delete;
  ~TransientMemory() {
    if (memory_ != nullptr) memory_->release(memory_->taken() - before_);
  }

 private:
  MemoryBudget* memory_;
  std::uint64_t before_;
};

/// The charge for arrays that grow element by element.
class GrowingMemory {
 public:
  ///   memory  may be null
  explicit GrowingMemory(MemoryBudget* memory) : memory_(memory) {}

  /// Charges arrays of a total size of `bytes`, now or before the next call.
  ///   throws  Error(input)
  void hold(std::uint64_t bytes) {
    // A full array is copied to one of twice the capacity: both exist for a moment.
    constexpr std::uint64_t kRoom = 3;
    if (memory_ == nullptr || kRoom * bytes <= charged_) return;
    memory_->charge(kRoom * bytes - charged_);
    charged_ = kRoom * bytes;
  }

 private:
  MemoryBudget* memory_;
  std::uint64_t charged_ = 0;
};

}  // namespace sherd
