// Work on a thread of its own, beside the interpreter.
//
// The calling thread waits in Python code, by poll() on Job::file(): so an interrupt reaches it at
// once, whatever the work is doing, the callback for progress runs on it and on no other, and an
// interpreter that closes finds no frame of C++ on a thread that waits for its lock.  The thread
// of the work never uses Python.  It is kept for the next job, and ended before a fork with all
// that TBB keeps for a thread, so that TBB can be stopped then (process.h).
#pragma once

#include <nanobind/nanobind.h>
#include <sherd/progress.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace pysherd {

namespace nb = nanobind;

/// Converts what the work made to a Python object; called with the interpreter's lock.
using Made = std::function<nb::object()>;

/// The work; it holds no Python object.
using Work = std::function<Made(const sherd::Progress&)>;

class Job {
 public:
  struct State;

  /// Starts a thread.
  ///   throws  Error(device) the process was forked in a way that leaves it without threads;
  ///           Error(cancelled) the interpreter is closing
  explicit Job(Work work);
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  /// A file that can be read once the work is done.
  [[nodiscard]] int file() const;

  /// The stage, and the fraction of it that is done; an empty stage before the first.
  [[nodiscard]] std::pair<std::string, double> progress() const;

  /// Stops the work soon.  It may still go on when the job is gone.
  void cancel();

  /// What the work made; call it once, after file() can be read.
  ///   throws  what the work threw
  [[nodiscard]] nb::object result();

 private:
  std::shared_ptr<State> state_;
};

/// The number of jobs whose work goes on.
[[nodiscard]] std::size_t runningJobs();

/// Runs short work that uses TBB on a thread of jobs, and waits for it.  TBB would keep threads for
/// the caller's, and could not be stopped before a fork.
///   throws  what the work throws; std::system_error there is no thread
void onWorker(const std::function<void()>& work);

/// Ends the threads that wait for work, and with them what TBB keeps for each.
void stopIdleThreads();

/// Waits until no cancelled work goes on, at most `limit`.
void waitForCancelled(std::chrono::milliseconds limit);

/// Cancels all work, refuses more, and waits until none goes on, at most `limit`.
void closeJobs(std::chrono::milliseconds limit);

/// Forgets the jobs of the parent process, whose threads a forked process does not have.
void forgetJobs();

/// The most threads of a job; 0: all cores.
void limitThreads(int most);
[[nodiscard]] int threadLimit();

void bindJobs(nb::module_& module);

}  // namespace pysherd
