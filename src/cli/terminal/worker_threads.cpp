// The threads of TBB under limits of the system.
#include "cli/terminal/worker_threads.h"

#include <sys/resource.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <latch>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace sherd::cli {
namespace {

bool isLimited(__rlimit_resource kind) {
  rlimit limit{};
  return ::getrlimit(kind, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

// Returns how many threads can exist beside this one, up to `wanted`.
int possibleThreads(int wanted) {
  std::latch ended(1);
  std::vector<std::thread> threads;
  threads.reserve(static_cast<std::size_t>(wanted));
  try {
    while (static_cast<int>(threads.size()) < wanted) {
      threads.emplace_back([&ended] { ended.wait(); });
    }
  } catch (const std::system_error&) {  // there are no more
  } catch (const std::bad_alloc&) {     // nor memory for one
  }
  ended.count_down();
  for (std::thread& thread : threads) thread.join();
  return static_cast<int>(threads.size());
}

// Has each thread of TBB take one of as many tasks, so that all are started.
void startAll(int threads) {
  constexpr std::chrono::milliseconds kMost(100);  // TBB need not start them all
  const auto end = std::chrono::steady_clock::now() + kMost;
  std::atomic<int> begun{0};
  tbb::parallel_for(
      0, threads,
      [&](int) {
        ++begun;
        while (begun < threads && std::chrono::steady_clock::now() < end) {
          std::this_thread::yield();
        }
      },
      tbb::simple_partitioner());
}

}  // namespace

std::unique_ptr<tbb::global_control> startedWorkers() {
  const bool isTight = isLimited(RLIMIT_AS) || isLimited(RLIMIT_DATA);
  if (!isTight && !isLimited(RLIMIT_NPROC)) return nullptr;
  const int wanted = tbb::info::default_concurrency() - 1;
  std::unique_ptr<tbb::global_control> limited;
  for (int possible = possibleThreads(wanted);; possible = 0) {
    if (possible < wanted) {
      limited = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                      static_cast<std::size_t>(possible) + 1);
    }
    if (!isTight && possible == wanted) return limited;
    try {
      startAll(possible + 1);
      return limited;
    } catch (const std::exception&) {
      // The system counts a thread that has just ended; this one alone works always.
      if (possible == 0) return limited;
    }
  }
}

}  // namespace sherd::cli
