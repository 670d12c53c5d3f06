// Handles drivers that call exit().
#include "cli/terminal/foreign_exit.h"

#include <sherd/error.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>

#include "base/files/unfinished.h"
#include "cli/terminal/command.h"
#include "cli/terminal/interrupts.h"

namespace sherd::cli {
namespace {

std::atomic<bool> isForeign{false};

void explain(int, void*) {
  if (!isForeign) return;
  claimExit(static_cast<int>(ErrorCode::device));
  endAllWork();
  removeUnfinished();
  printMessage(
      "sherd: the OpenCL driver ended the program; see its output above, and sherd doctor for "
      "its kernel folder");
  ::_exit(static_cast<int>(ErrorCode::device));
}

}  // namespace

ForeignExit::ForeignExit() {
  static const int registered = ::on_exit(explain, nullptr);
  isForeign = registered == 0;
}

ForeignExit::~ForeignExit() { isForeign = false; }

}  // namespace sherd::cli
