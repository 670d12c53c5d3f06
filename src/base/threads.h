// Threads that may not start: ulimit -v and -d count their stacks, ulimit -u counts threads.
#pragma once

#include <sherd/error.h>

#include <exception>
#include <future>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

namespace sherd {

/// The sentence for a thread that the system refuses.
inline constexpr const char* kNoThread =
    "no thread can be started; allow this process more memory or threads (ulimit -v, -d, -u)";

/// Whether an exception is that of a thread that the system refuses, ours or one of TBB's.
inline bool isOfThread(const std::exception& error) {
  const auto* const system = dynamic_cast<const std::system_error*>(&error);
  return (system && system->code() == std::errc::resource_unavailable_try_again) ||
         std::string_view(error.what()).starts_with("pthread_create has failed");
}

/// Starts a thread.
///   throws  Error(internal) kNoThread
template <class Work>
std::thread startedThread(Work&& work) try {
  return std::thread(std::forward<Work>(work));
} catch (const std::system_error&) {
  throw Error(ErrorCode::internal, kNoThread);
}

/// Does work in a thread, or where none can be started in the caller's, once its result is read.
template <class Work, class... Arguments>
auto startedTask(Work&& work, Arguments&&... arguments) {
  return std::async(std::launch::async | std::launch::deferred, std::forward<Work>(work),
                    std::forward<Arguments>(arguments)...);
}

}  // namespace sherd
