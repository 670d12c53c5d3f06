// Progress line on a terminal.
#include "cli/terminal/progress_line.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace sherd::cli {

std::atomic<bool> lineIsDrawn{false};

void ProgressLine::show(std::string_view stage, double fraction) {
  constexpr int kWidth = 40;
  const auto now = std::chrono::steady_clock::now();
  if (!shown_ || (lineIsDrawn && now - last_ < std::chrono::milliseconds(100))) return;
  const int full = static_cast<int>(std::lround(std::clamp(fraction, 0.0, 1.0) * kWidth));
  const std::string bar(static_cast<std::size_t>(full), '#');
  std::fprintf(stderr, "\r%-10.*s [%-*s] %3d %%", static_cast<int>(stage.size()), stage.data(),
               kWidth, bar.c_str(), full * 100 / kWidth);
  last_ = now;
  lineIsDrawn = true;
}

void ProgressLine::clear() {
  if (lineIsDrawn.exchange(false)) std::fputs(kClearLine, stderr);
}

}  // namespace sherd::cli
