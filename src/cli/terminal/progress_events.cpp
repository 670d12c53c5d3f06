// Progress for programs: JSON on standard error, an object a line.
#include "cli/terminal/progress_events.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace sherd::cli {
namespace {

// Of a pipe that nobody reads, this much is filled, and the rest left to warnings and errors, which
// wait for room: most hold 64 KiB.
constexpr int kMostUnread = 16 << 10;

// Whether a line can be written to standard error without waiting.
bool hasRoom() {
  pollfd to{STDERR_FILENO, POLLOUT, 0};
  if (::poll(&to, 1, 0) != 1 || (to.revents & POLLOUT) == 0) return false;
  struct stat kind {};
  int unread = 0;
  const bool isPipe = ::fstat(STDERR_FILENO, &kind) == 0 && S_ISFIFO(kind.st_mode);
  return !isPipe || ::ioctl(STDERR_FILENO, FIONREAD, &unread) != 0 || unread < kMostUnread;
}

// Bypasses stdio, which would wait for a reader.
void writeLine(std::string_view stage, double fraction, double overall) {
  if (!hasRoom()) return;
  char line[160];
  const int length = std::snprintf(
      line, sizeof line, "{\"stage\": \"%.*s\", \"fraction\": %.3f, \"overall\": %.4f}\n",
      static_cast<int>(stage.size()), stage.data(), std::clamp(fraction, 0.0, 1.0), overall);
  if (length <= 0 || length >= static_cast<int>(sizeof line)) return;
  [[maybe_unused]] const ssize_t n = ::write(STDERR_FILENO, line, static_cast<std::size_t>(length));
}

}  // namespace

void ProgressEvents::show(std::string_view stage, double fraction) {
  if (!shown_) return;
  const double overall = overall_.update(stage, fraction);
  const auto now = std::chrono::steady_clock::now();
  const bool isNew = begun_.emplace(stage).second;
  if (!isNew && now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  writeLine(stage, fraction, overall);
}

void ProgressEvents::finish() {
  if (shown_) writeLine("done", 1.0, 1.0);
}

}  // namespace sherd::cli
