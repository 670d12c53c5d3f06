// Exceptions that nothing catches.
#include "cli/terminal/uncaught.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <exception>
#include <new>

#include "base/files/unfinished.h"
#include "base/threads.h"
#include "cli/terminal/command.h"
#include "cli/terminal/interrupts.h"

namespace sherd::cli {
namespace {

constexpr unsigned kSeconds = 2;   // to remove temporary files
std::atomic<bool> hasWork{false};  // main has begun

// Writes without allocating: memory may be what is missing.
void put(const char* text) {
  [[maybe_unused]] const ssize_t n = ::write(STDERR_FILENO, text, std::strlen(text));
}

void putReason() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
    put("internal error: the program ended itself");
  } catch (const std::bad_alloc&) {
    put(kNoMemory);
  } catch (const std::exception& e) {
    if (isOfThread(e)) return put(kNoThread);
    put("internal error: ");
    put(e.what());
  } catch (...) {
    put("internal error");
  }
}

[[noreturn]] void end() {
  if (hasWork) claimExit(static_cast<int>(ErrorCode::internal));
  put("sherd: ");
  putReason();
  put("\n");
  if (hasWork) {
    // This thread may hold what these wait for.
    std::signal(SIGALRM, [](int) { ::_exit(static_cast<int>(ErrorCode::internal)); });
    ::alarm(kSeconds);
    endAllWork();
    removeUnfinished();
  }
  ::_exit(static_cast<int>(ErrorCode::internal));
}

// Before the constructors of the libraries: log4cplus, which OpenVDB is linked with, starts threads
// in one of them.
void beforeLibraries() { std::set_terminate(end); }
[[gnu::section(".preinit_array"), gnu::used]] void (*const first)() = beforeLibraries;

}  // namespace

void endUncaughtOrderly() {
  std::set_terminate(end);
  hasWork = true;
}

}  // namespace sherd::cli
