// Progress line on a terminal, redrawn at most ten times a second.
#pragma once

#include <atomic>
#include <chrono>
#include <string_view>

namespace sherd::cli {

/// Whether a progress line must be cleared, by printing kClearLine, before other output.  Any
/// thread may read it.
extern std::atomic<bool> lineIsDrawn;
constexpr const char* kClearLine = "\r\x1b[K";

class ProgressLine {
 public:
  ///   shown  false: draws nothing
  explicit ProgressLine(bool shown) : shown_(shown) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Draws the line, unless it was drawn less than 0.1 s ago.
  ///   fraction  of the stage, 0..1
  void show(std::string_view stage, double fraction);
  void clear();

 private:
  bool shown_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace sherd::cli
