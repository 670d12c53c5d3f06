// Handles SIGINT, SIGTERM and SIGHUP: cancels long work, and ends the process if it does not stop.
#pragma once

#include <sherd/progress.h>

#include <functional>
#include <string>

#include "base/files/unfinished.h"

namespace sherd::cli {

/// Makes isInterrupted() report SIGINT, SIGTERM and SIGHUP, unless the caller ignores them.  A
/// process that still runs 0.7 s after a signal, for example in a foreign library or while memory
/// is freed, is ended: temporaries are removed and interruptSentence() is printed.  Must be called
/// before any thread starts.
void watchForInterrupts();

/// Returns whether a signal came before commitStatus().
[[nodiscard]] bool isInterrupted();

/// Throws Error(cancelled) if isInterrupted().
void stopIfInterrupted();

/// Returns a Progress that only cancels on interrupts, and reports nothing.
[[nodiscard]] const Progress& untilInterrupted();

/// Sets what interruptSentence() adds about the files, for example "DIR is as it was before".
void setInterruptedState(std::string state);

/// Returns "interrupted; " and the interrupted state, or "interrupted" without one.
[[nodiscard]] std::string interruptSentence();

/// Disables cancellation: the files are in place and the result is printed.  A process that still
/// runs a while after a signal is ended with this status.
void commitStatus(int status);

/// Rethrows the current exception, with `notUndone` appended to its message.
///   notUndone  continues a sentence; empty: appends nothing
[[noreturn]] void rethrowWith(const std::string& notUndone);

/// Moves pending files into place, prints the result, and keeps the files, all or nothing: statuses
/// 130 and 5 mean that nothing was replaced, or that the message lists what was.
///   aside   has putInPlace(), keep(), and drop(), which undoes and returns what it cannot undo
///   print   throws if standard output fails, or on an interrupt while it blocks
///   status  of the command, used if the process is ended after this
template <class Aside>
void finish(Aside& aside, const std::function<void()>& print, int status = 0) {
  stopIfInterrupted();
  {
    const Uncut whole;
    try {
      aside.putInPlace();
      print();
    } catch (...) {
      rethrowWith(aside.drop());
    }
    commitStatus(status);
  }
  aside.keep();
}

/// Reserves the end of the process for the caller, with this status.  Does not return if an
/// interrupt is already ending the process.
void claimExit(int status);

}  // namespace sherd::cli
