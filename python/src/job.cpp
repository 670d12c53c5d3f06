// Work on a thread of its own, beside the interpreter.
#include "job.h"

#include <nanobind/stl/pair.h>
#include <sherd/error.h>
#include <sys/eventfd.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <future>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>
#include <thread>
#include <vector>

#include "process.h"
#include "text.h"

namespace pysherd {

struct Job::State {
  State() : file(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (file < 0) throw std::system_error(errno, std::generic_category(), "no file for a job");
  }
  ~State() { ::close(file); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  const int file;
  std::atomic<bool> isCancelled{false};
  std::mutex mutex;  // guards the two below
  std::string stage;
  double fraction = 0.0;
  // Of the work, until `file` can be read:
  Made made;
  std::exception_ptr error;
};

namespace {

// Signals are for the interpreter's thread, and TBB's threads inherit what is blocked here.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_BLOCK, &all, &before_);
  }
  ~BlockedSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_{};
};

// A thread that does the work of one job after another.  A new one for each would cost as much as a
// small fracture: TBB and malloc keep a lot for each thread.
class Worker {
 public:
  Worker() : thread_([this] { loop(); }) {}
  ~Worker() {
    give(nullptr);
    thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Starts work; without any the thread ends.
  void give(std::function<void()> work) {
    {
      const std::lock_guard lock(mutex_);
      work_ = std::move(work);
      isGiven_ = true;
    }
    given_.notify_one();
  }

 private:
  void loop() {
    for (;;) {
      std::unique_lock lock(mutex_);
      given_.wait(lock, [this] { return isGiven_; });
      const std::function<void()> work = std::exchange(work_, nullptr);
      isGiven_ = false;
      lock.unlock();
      if (!work) return;
      work();
    }
  }

  std::mutex mutex_;
  std::condition_variable given_;
  std::function<void()> work_;
  bool isGiven_ = false;
  std::thread thread_;
};

// All jobs of this process.  Never destroyed: threads may outlive the end of main().
struct Jobs {
  std::mutex mutex;
  std::condition_variable ended;
  std::set<Job::State*> running;
  std::vector<std::unique_ptr<Worker>> idle;
  bool isClosing = false;
};
Jobs* jobs = new Jobs;
std::atomic<int> mostThreads{0};

void begin(Job::State& state) {
  const std::lock_guard lock(jobs->mutex);
  if (jobs->isClosing) {
    throw sherd::Error(sherd::ErrorCode::cancelled, "the interpreter is closing");
  }
  jobs->running.insert(&state);
}

// Returns an idle thread, or a new one.
std::unique_ptr<Worker> takeWorker() {
  {
    const std::lock_guard lock(jobs->mutex);
    if (!jobs->idle.empty()) {
      std::unique_ptr<Worker> worker = std::move(jobs->idle.back());
      jobs->idle.pop_back();
      return worker;
    }
  }
  const BlockedSignals blocked;
  return std::make_unique<Worker>();
}

// The worker is idle before the caller learns that the work is done, so that it can be stopped
// then.
void end(Job::State& state, std::unique_ptr<Worker> worker) {
  Jobs& all = *jobs;
  {
    const std::lock_guard lock(all.mutex);
    all.running.erase(&state);
    if (worker) all.idle.push_back(std::move(worker));
    all.ended.notify_all();
  }
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(state.file, &one, sizeof one);
}

sherd::Progress progressOf(Job::State& state) {
  return {.report =
              [&state](std::string_view stage, double fraction) {
                const std::lock_guard lock(state.mutex);
                state.stage = stage;
                state.fraction = fraction;
              },
          .cancelled = [&state] { return state.isCancelled.load(std::memory_order_relaxed); }};
}

void runWork(Job::State& state, Work work) {
  const sherd::Progress progress = progressOf(state);
  const int most = threadLimit();
  try {
    if (most > 0) {
      tbb::task_arena arena(most);
      arena.execute([&] { state.made = work(progress); });
    } else {
      state.made = work(progress);
    }
  } catch (...) {
    state.error = std::current_exception();
  }
  work = nullptr;  // frees what it holds on this thread, before the caller goes on
}

}  // namespace

Job::Job(Work work) : state_(std::make_shared<State>()) {
  requireUsableProcess();
  begin(*state_);
  try {
    std::unique_ptr<Worker> owned = takeWorker();
    Worker* const worker = owned.release();  // owned by its work until that is done
    worker->give([state = state_, work = std::move(work), worker]() mutable {
      runWork(*state, std::move(work));
      end(*state, std::unique_ptr<Worker>(worker));
    });
  } catch (const std::system_error&) {
    end(*state_, nullptr);
    throw sherd::Error(sherd::ErrorCode::device, "the system has no thread left for the work");
  }
}

Job::~Job() { cancel(); }

int Job::file() const { return state_->file; }

std::pair<std::string, double> Job::progress() const {
  const std::lock_guard lock(state_->mutex);
  return {state_->stage, state_->fraction};
}

void Job::cancel() { state_->isCancelled = true; }

nb::object Job::result() {
  if (state_->error) std::rethrow_exception(std::exchange(state_->error, nullptr));
  const Made made = std::exchange(state_->made, nullptr);
  return made ? made() : nb::none();
}

std::size_t runningJobs() {
  const std::lock_guard lock(jobs->mutex);
  return jobs->running.size();
}

void waitForCancelled(std::chrono::milliseconds limit) {
  std::unique_lock lock(jobs->mutex);
  jobs->ended.wait_for(lock, limit, [] {
    return std::none_of(jobs->running.begin(), jobs->running.end(),
                        [](const Job::State* state) { return state->isCancelled.load(); });
  });
}

void closeJobs(std::chrono::milliseconds limit) {
  std::unique_lock lock(jobs->mutex);
  jobs->isClosing = true;
  for (Job::State* const state : jobs->running) state->isCancelled = true;
  jobs->ended.wait_for(lock, limit, [] { return jobs->running.empty(); });
  lock.unlock();
  stopIdleThreads();
}

void onWorker(const std::function<void()>& work) {
  std::unique_ptr<Worker> worker = takeWorker();
  const auto done = std::make_shared<std::promise<void>>();  // the worker may still hold it
  worker->give([done, &work] {
    try {
      work();
      done->set_value();
    } catch (...) {
      done->set_exception(std::current_exception());
    }
  });
  std::future<void> ended = done->get_future();
  ended.wait();
  {
    const std::lock_guard lock(jobs->mutex);
    if (!jobs->isClosing) jobs->idle.push_back(std::move(worker));
  }
  worker.reset();  // ends it if the interpreter is closing
  ended.get();
}

void stopIdleThreads() {
  std::vector<std::unique_ptr<Worker>> idle;
  {
    const std::lock_guard lock(jobs->mutex);
    idle.swap(jobs->idle);
  }
}  // whose threads end here

void forgetJobs() { jobs = new Jobs; }  // whose mutex may be locked for good here

void limitThreads(int most) { mostThreads = most; }
int threadLimit() { return mostThreads; }

void bindJobs(nb::module_& module) {
  nb::class_<Job>(module, "Job")
      .def_prop_ro("file", &Job::file)
      .def_prop_ro("progress", &Job::progress)
      .def("cancel", &Job::cancel)
      .def("result", &Job::result);
  module.def(
      "close_jobs", [](int milliseconds) { closeJobs(std::chrono::milliseconds(milliseconds)); },
      nb::call_guard<nb::gil_scoped_release>());
  module.def("limit_threads", limitThreads);
  module.def("thread_limit", threadLimit);
}

}  // namespace pysherd
