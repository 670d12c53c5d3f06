// Writes files in the background.
#include "dataset/store/file_queue.h"

#include <chrono>
#include <new>
#include <utility>

#include "base/files/atomic_file.h"
#include "base/threads.h"

namespace sherd {

FileQueue::FileQueue(std::size_t mostBytes, int threads) : mostBytes_(mostBytes) {
  const auto most = static_cast<std::size_t>(threads);
  threads_.reserve(most);
  threads_.push_back(startedThread([this] { work(); }));
  try {
    while (threads_.size() < most) threads_.push_back(startedThread([this] { work(); }));
  } catch (const Error&) {           // fewer do
  } catch (const std::bad_alloc&) {  // as well
  }
}

FileQueue::~FileQueue() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void FileQueue::add(std::filesystem::path file, ByteBlocks bytes, Done done) {
  const std::size_t size = bytes.size();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return bytes_ == 0 || bytes_ + size <= mostBytes_; });
  entries_.push_back({std::move(file), std::move(bytes), std::move(done)});
  bytes_ += size;
  lock.unlock();
  changed_.notify_all();
}

void FileQueue::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return closed_ || !entries_.empty(); });
    if (entries_.empty()) return;
    Entry entry = std::move(entries_.front());
    entries_.pop_front();
    lock.unlock();
    const auto begin = std::chrono::steady_clock::now();
    std::exception_ptr problem;
    try {
      AtomicFile file(entry.file, Caching::none);
      file.write(entry.bytes.pieces());
      file.commit();
    } catch (...) {
      problem = std::current_exception();
    }
    const std::size_t size = entry.bytes.size();
    entry.bytes.clear();
    entry.done(problem,
               std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    lock.lock();
    bytes_ -= size;
    changed_.notify_all();
  }
}

}  // namespace sherd
