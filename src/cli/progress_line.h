// Progress on a terminal: one line, redrawn some ten times a second.
#pragma once

#include <atomic>
#include <chrono>
#include <string_view>

namespace sherd::cli {

/// Whether the terminal's last line is to be cleared before anything else is printed, and what
/// clears it; any thread may ask.
extern std::atomic<bool> lineIsDrawn;
constexpr const char* kClearLine = "\r\x1b[K";

class ProgressLine {
 public:
  ///   shown  false: nothing is ever drawn
  explicit ProgressLine(bool shown) : shown_(shown) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  ///   fraction  of the stage, 0..1
  void show(std::string_view stage, double fraction);
  void clear();

 private:
  bool shown_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace sherd::cli
