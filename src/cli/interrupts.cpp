// Ctrl-C as a flag.
#include "cli/interrupts.h"

#include <sherd/error.h>

#include <atomic>
#include <csignal>
#include <thread>

namespace sherd::cli {
namespace {

std::atomic<bool> interrupted{false};

}  // namespace

// Signals are blocked in every thread and waited for in one, instead of handled: while a kernel is
// built, LLVM puts handlers of its own in place, which delete the compiler's files and turn a
// ctrl-C into a failed build.  A signal that the caller ignores stays ignored.
void watchForInterrupts() {
  sigset_t watched;
  ::sigemptyset(&watched);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    ::sigaction(number, nullptr, &action);
    if (action.sa_handler != SIG_IGN) ::sigaddset(&watched, number);
  }
  ::pthread_sigmask(SIG_BLOCK, &watched, nullptr);
  std::thread([watched] {
    int number = 0;
    while (::sigwait(&watched, &number) == 0) interrupted = true;
  }).detach();
}

bool isInterrupted() { return interrupted; }

void stopIfInterrupted() {
  if (interrupted) throw Error(ErrorCode::cancelled, "");
}

}  // namespace sherd::cli
