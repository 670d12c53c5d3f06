// Ctrl-C: asks long work to stop, and ends the process where that is not heeded.
#pragma once

#include <sherd/progress.h>

#include <functional>
#include <string>

#include "base/unfinished.h"

namespace sherd::cli {

/// From now on SIGINT, SIGTERM and SIGHUP, unless the caller ignores them, are asked for by
/// isInterrupted().  Where the process still lives 0.7 s later, as in a foreign library or while
/// memory is freed, it is ended: temporaries are taken away, and interruptSentence() is printed.
/// To be called before any thread is started.
void watchForInterrupts();

/// Whether one of them came, and the last steps have not begun.
[[nodiscard]] bool isInterrupted();

/// throws Error(cancelled) where one came
void stopIfInterrupted();

/// For work that is asked to stop and does not show how far it is.
[[nodiscard]] const Progress& untilInterrupted();

/// What an interrupted command leaves behind, as "DIR is as it was before".
void setInterruptedState(std::string state);

/// "interrupted; " and that.
[[nodiscard]] std::string interruptSentence();

/// What was written aside is in place and the result is printed: from here on an interrupt does not
/// stop the work.  Where the process still lives a while after one, it is ended with this status.
void goOnToTheEnd(int status);

/// Throw again what is being handled, and add to its message what could not be undone.
///   notUndone  in the middle of a sentence; empty: nothing is added
[[noreturn]] void throwAgain(const std::string& notUndone);

/// Put what was written aside in place, print the result, and keep it: all of it or nothing, so
/// that statuses 130 and 5 mean that nothing was replaced, or that the message says what was.
///   aside   has putInPlace(), keep(), and drop(), which undoes and returns what it cannot undo
///   print   throws where nobody takes the result, or an interrupt comes while it waits for that
///   status  that the command has then
template <class Aside>
void finish(Aside& aside, const std::function<void()>& print, int status = 0) {
  stopIfInterrupted();
  {
    const Uncut whole;
    try {
      aside.putInPlace();
      print();
    } catch (...) {
      throwAgain(aside.drop());
    }
    goOnToTheEnd(status);
  }
  aside.keep();
}

/// The caller is about to end the process with this status, after a message.  Where an interrupt
/// ends it already, this does not return.
void endWith(int status);

}  // namespace sherd::cli
