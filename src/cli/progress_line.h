// Progress on a terminal: one line, redrawn some ten times a second.
#pragma once

#include <chrono>
#include <string_view>

namespace sherd::cli {

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
  bool drawn_ = false;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace sherd::cli
