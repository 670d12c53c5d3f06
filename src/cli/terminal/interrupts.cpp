// Handles SIGINT, SIGTERM and SIGHUP.
#include "cli/terminal/interrupts.h"

#include <poll.h>
#include <sherd/error.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "base/files/unfinished.h"
#include "base/text/printable.h"
#include "cli/terminal/progress_line.h"

namespace sherd::cli {
namespace {

constexpr std::chrono::milliseconds kOrderly(700);   // for work that polls isInterrupted()
constexpr std::chrono::milliseconds kMessage(1000);  // for the last message of such work

std::atomic<bool> interrupted{false};
std::atomic<bool> committed{false};   // by commitStatus()
std::atomic<int> committedStatus{0};  // valid once that is set
std::atomic<int> status{-1};          // of the thread that ends the process; -1: none yet

std::mutex stateMutex;
std::string state;  // guarded by stateMutex

// Returns whether the caller is the first to end the process.
bool claimEnd(int with) {
  int none = -1;
  return status.compare_exchange_strong(none, with);
}

[[noreturn]] void waitForEnd() {
  for (;;) ::pause();
}

// Prints to standard error unless that blocks.  Bypasses stdio: a blocked thread may hold its lock.
void printAtOnce(const std::string& text) {
  constexpr int kMilliseconds = 100;
  pollfd to{STDERR_FILENO, POLLOUT, 0};
  if (::poll(&to, 1, kMilliseconds) <= 0) return;
  [[maybe_unused]] const ssize_t n = ::write(STDERR_FILENO, text.data(), text.size());
}

// Ends a process that did not stop in time.
[[noreturn]] void endAtOnce() {
  if (committed) std::this_thread::sleep_for(kMessage);  // it is about to finish
  endAllWork();                                          // waits for renames
  const bool isDone = committed;
  if (!claimEnd(isDone ? committedStatus.load() : static_cast<int>(ErrorCode::cancelled))) {
    std::this_thread::sleep_for(kMessage);
    ::_exit(status);
  }
  try {
    removeUnfinished();
    if (!isDone) {
      printAtOnce((lineIsDrawn ? kClearLine : "") + printable("sherd: " + interruptSentence()) +
                  "\n");
    }
  } catch (const std::exception&) {
    // No memory for the message; the status is enough.
  }
  ::_exit(status);
}

}  // namespace

// Signals are blocked in every thread, and one thread waits for them, instead of handlers: while it
// builds a kernel, LLVM installs its own handlers, which delete the compiler's files and turn a
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
  try {
    std::thread([watched] {
      int number = 0;
      while (::sigwait(&watched, &number) != 0) {
      }
      interrupted = true;
      std::this_thread::sleep_for(kOrderly);
      endAtOnce();
    }).detach();
  } catch (const std::system_error&) {  // no thread available: default signal actions apply
    ::pthread_sigmask(SIG_UNBLOCK, &watched, nullptr);
  }
}

bool isInterrupted() { return interrupted && !committed; }

void stopIfInterrupted() {
  if (isInterrupted()) throw Error(ErrorCode::cancelled, "");
}

const Progress& untilInterrupted() {
  static const Progress progress{.report = {}, .cancelled = isInterrupted};
  return progress;
}

void setInterruptedState(std::string left) {
  const std::lock_guard lock(stateMutex);
  state = std::move(left);
}

std::string interruptSentence() {
  const std::lock_guard lock(stateMutex);
  return state.empty() ? "interrupted" : "interrupted; " + state;
}

void commitStatus(int with) {
  committedStatus = with;
  committed = true;
}

void rethrowWith(const std::string& notUndone) {
  if (notUndone.empty()) throw;
  setInterruptedState(notUndone);
  try {
    throw;
  } catch (const Error& e) {
    throw Error(e.code(), std::string(e.what()) + "; " + notUndone, e.options());
  } catch (const std::exception& e) {
    throw Error(ErrorCode::internal, std::string(e.what()) + "; " + notUndone);
  }
}

void claimExit(int with) {
  if (!claimEnd(with)) waitForEnd();
}

}  // namespace sherd::cli
