// Ctrl-C.
#include "cli/interrupts.h"

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

#include "base/unfinished.h"
#include "cli/progress_line.h"

namespace sherd::cli {
namespace {

constexpr std::chrono::milliseconds kOrderly(700);   // for work that asks whether to stop
constexpr std::chrono::milliseconds kMessage(1000);  // for the last message of such work

std::atomic<bool> interrupted{false};
std::atomic<bool> last{false};
std::atomic<int> lastStatus{0};  // once that is set
std::atomic<int> status{-1};     // of whoever ends the process; -1: nobody yet

std::mutex stateMutex;
std::string state;  // by stateMutex

// Whether the caller is the first to end the process.
bool claimEnd(int with) {
  int nobody = -1;
  return status.compare_exchange_strong(nobody, with);
}

[[noreturn]] void waitForEnd() {
  for (;;) ::pause();
}

// To standard error, unless that blocks; past its buffer, which a blocked thread may hold.
void printAtOnce(const std::string& text) {
  constexpr int kMilliseconds = 100;
  pollfd to{STDERR_FILENO, POLLOUT, 0};
  if (::poll(&to, 1, kMilliseconds) <= 0) return;
  [[maybe_unused]] const ssize_t n = ::write(STDERR_FILENO, text.data(), text.size());
}

// The end of a process that does not heed the flag.
[[noreturn]] void endAtOnce() {
  if (last) std::this_thread::sleep_for(kMessage);  // it is nearly done
  endAllWork();                                     // waits for renames
  const bool isDone = last;
  if (!claimEnd(isDone ? lastStatus.load() : static_cast<int>(ErrorCode::cancelled))) {
    std::this_thread::sleep_for(kMessage);
    ::_exit(status);
  }
  try {
    removeUnfinished();
    if (!isDone) {
      printAtOnce((lineIsDrawn ? kClearLine : "") + ("sherd: " + interruptSentence() + "\n"));
    }
  } catch (const std::exception&) {
    // No memory for the message: the status says it.
  }
  ::_exit(status);
}

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
  try {
    std::thread([watched] {
      int number = 0;
      while (::sigwait(&watched, &number) != 0) {
      }
      interrupted = true;
      std::this_thread::sleep_for(kOrderly);
      endAtOnce();
    }).detach();
  } catch (const std::system_error&) {  // no thread is to be had: signals do what they always do
    ::pthread_sigmask(SIG_UNBLOCK, &watched, nullptr);
  }
}

bool isInterrupted() { return interrupted && !last; }

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

void goOnToTheEnd(int with) {
  lastStatus = with;
  last = true;
}

void throwAgain(const std::string& notUndone) {
  if (notUndone.empty()) throw;
  setInterruptedState(notUndone);
  try {
    throw;
  } catch (const Error& e) {
    throw Error(e.code(), std::string(e.what()) + "; " + notUndone);
  } catch (const std::exception& e) {
    throw Error(ErrorCode::internal, std::string(e.what()) + "; " + notUndone);
  }
}

void endWith(int with) {
  if (!claimEnd(with)) waitForEnd();
}

}  // namespace sherd::cli
